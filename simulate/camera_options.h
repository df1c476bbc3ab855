// SPDX-License-Identifier: GPL-3.0-or-later
// Options of a camera on the flight.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/config/option.h"

namespace swath::simulate {

struct CameraOptions {
  bool file = false, photos = false;
  core::Metres f{0.05021}, x0{0.000021}, y0{-0.000034}, nominal_f{0.05};
  double k1 = -2.1e-5, k2 = 1.2e-8, k3 = 0.0, p1 = 3e-6, p2 = -4e-6;
  int columns = 7216, rows = 5412;
  core::Metres pixel{6.8e-6};
  core::Radians mount = core::degrees(90.0);
  std::array<core::Radians, 3> boresight{core::degrees(0.31), core::degrees(-0.22), core::degrees(0.53)};
  core::Radians boresight_sigma = core::degrees(0.02);
  std::array<core::Metres, 3> lever_arm{core::Metres(0.21), core::Metres(-0.08), core::Metres(0.34)};
  core::Metres lever_arm_sigma{0.01};
  int points = 80;
  double noise = 0.33;
  core::Metres station_horizontal{0.04}, station_vertical{0.06}, shift, drift;
  core::Radians roll_pitch = core::degrees(0.005), heading = core::degrees(0.01);
  int control = 5, check = 15;
  core::Metres control_sigma{0.02};

  /// Half the image's diagonal over the principal distance.
  double reach() const { return std::hypot(columns, rows) / 2.0 * pixel.value / f.value; }
};

template <class V>
void describe(CameraOptions& c, V& v) {
  v.option("file", c.file, "Writes image points, control, their tables of survey.toml, block.toml; exposures are the events.");
  v.option("photos", c.photos, "Writes the photographs, too: photos/, a ray for each pixel; take few columns and rows.");
  v.option("f", c.f, core::above(0), "Principal distance.");
  v.option("nominal_f", c.nominal_f, core::above(0), "Principal distance that block.toml starts from.");
  v.option("x0", c.x0, "Principal point from the middle of the sensor, to the right.");
  v.option("y0", c.y0, "Principal point from the middle of the sensor, up.");
  v.option("k1", c.k1, "Radial distortion, measured less ideal, of the ideal point, mm^-2.", "Brown1971");
  v.option("k2", c.k2, "The same, mm^-4.");
  v.option("k3", c.k3, "The same, mm^-6; block.toml holds it.");
  v.option("p1", c.p1, "Decentring distortion, mm^-1.");
  v.option("p2", c.p2, "Decentring distortion in y, mm^-1.");
  v.option("columns", c.columns, core::within(100, 100000), "Pixels across.");
  v.option("rows", c.rows, core::within(100, 100000), "Pixels down.");
  v.option("pixel", c.pixel, core::above(0), "Side of a pixel.");
  v.option("mount", c.mount, "Angle from the direction of flight to the image's x axis, clockwise from above.");
  v.option("boresight", c.boresight, "True roll, pitch, heading of the camera in the body, beside mount; block.toml starts from 0.");
  v.option("boresight_sigma", c.boresight_sigma, core::within(0, 0.1),
           "Sigma of the boresight's angles in survey.toml, whose errors are sampled; 0: true and held.");
  v.option("lever_arm", c.lever_arm, "IMU centre to perspective centre: forward, right, down.");
  v.option("lever_arm_sigma", c.lever_arm_sigma, core::within(0, 1),
           "Sigma of its components in survey.toml, whose errors are sampled; 0: true and held.");
  v.option("points", c.points, core::within(6, 100000), "Tie points per image, about.");
  v.option("noise", c.noise, core::within(0, 10), "Sigma of an image coordinate, pixels.");
  v.option("station_horizontal", c.station_horizontal, core::within(0, 100), "Sigma of a station's easting and northing.");
  v.option("station_vertical", c.station_vertical, core::within(0, 100), "Sigma of a station's height.");
  v.option("shift", c.shift, core::within(0, 100), "Sigma of the stations' shift at the first image of a line, sampled for each line.",
           "Ackermann, eq 1");
  v.option("drift", c.drift, core::within(0, 100), "Sigma of its change to the last image.", "Ackermann, eq 1");
  v.option("roll_pitch", c.roll_pitch, core::within(0, 0.1), "Sigma of the observed roll and pitch.");
  v.option("heading", c.heading, core::within(0, 0.1), "Sigma of the observed heading.");
  v.option("control", c.control, core::within(0, 1000), "Control points, the first four in the corners of the flight.");
  v.option("check", c.check, core::within(0, 10000), "Check points.");
  v.option("control_sigma", c.control_sigma, core::within(0, 10), "Sigma of a control coordinate.");
}

}  // namespace swath::simulate
