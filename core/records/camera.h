// SPDX-License-Identifier: GPL-3.0-or-later
// What is stated of a frame camera: interior orientation with Brown's distortion, sensor, mounting.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/config/option.h"

namespace swath::core {

/// Where the distortion is evaluated.
enum class DistortionAt { ideal, measured };

/// Sigmas of a camera's values: "held", "free", or the sigma of an observed value.
struct CameraSigmas {
  std::string f = "held", x0 = "held", y0 = "held", k1 = "held", k2 = "held", k3 = "held", p1 = "held", p2 = "held", b1 = "held",
              b2 = "held", boresight = "held";
};

template <class V>
void describe(CameraSigmas& s, V& v) {
  v.option("f", s.f, "\"held\", \"free\", or a sigma with its unit: \"0.01 mm\".");
  v.option("x0", s.x0, "The same of x0.");
  v.option("y0", s.y0, "The same of y0.");
  v.option("k1", s.k1, "\"held\", \"free\", or a sigma in the value's unit: \"1e-9\".");
  v.option("k2", s.k2, "The same of k2.");
  v.option("k3", s.k3, "The same of k3.");
  v.option("p1", s.p1, "The same of p1.");
  v.option("p2", s.p2, "The same of p2.");
  v.option("b1", s.b1, "The same of b1.");
  v.option("b2", s.b2, "The same of b2.");
  v.option("boresight", s.boresight, "\"held\", \"free\", or a sigma of each angle: \"0.1 deg\". Needs observed angles.");
}

struct FrameCamera {
  std::string name = "camera";
  Metres f{0.1}, x0{}, y0{};
  double k1 = 0.0, k2 = 0.0, k3 = 0.0, p1 = 0.0, p2 = 0.0, b1 = 0.0, b2 = 0.0;
  std::optional<DistortionAt> distortion;
  int columns = 0, rows = 0;
  std::optional<Metres> pixel;
  Radians mount{};
  std::array<Radians, 3> boresight{};
};

template <class V>
void describe(FrameCamera& c, V& v) {
  v.option("name", c.name, "Name.");
  v.option("f", c.f, above(0), "Principal distance.");
  v.option("x0", c.x0, "Principal point from the middle of the sensor, to the right.");
  v.option("y0", c.y0, "Principal point from the middle of the sensor, up.");
  v.option("k1", c.k1, "Radial distortion, measured less ideal, mm^-2.", "Brown1971");
  v.option("k2", c.k2, "The same, mm^-4.");
  v.option("k3", c.k3, "The same, mm^-6.");
  v.option("p1", c.p1, "Decentring distortion, mm^-1: p1 (r^2 + 2 x^2) + 2 p2 x y in x.");
  v.option("p2", c.p2, "The same in y, mm^-1.");
  v.option("b1", c.b1, "Scale of x against y: b1 x in x.");
  v.option("b2", c.b2, "Shear: b2 y in x.");
  v.option("distortion", c.distortion, "Point that the distortion is computed from; needed where there is or may be any.");
  v.option("columns", c.columns, within(0, 1e6), "Pixels across; needed for image points in pixels.");
  v.option("rows", c.rows, within(0, 1e6), "Pixels down; needed for image points in pixels.");
  v.option("pixel", c.pixel, above(0), "Side of a pixel; needed for image points in pixels.");
  v.option("mount", c.mount, "Angle from the direction of flight to the image's x axis, clockwise from above.");
  v.option("boresight", c.boresight, "Roll, pitch, heading of the camera in the body, beside mount.");
}

/// True where there is distortion, or may be after an adjustment, and it is not stated which point it is computed from.
inline bool lacks_distortion(const FrameCamera& c, const CameraSigmas& s) {
  if (c.distortion) return false;
  for (const double value : {c.k1, c.k2, c.k3, c.p1, c.p2, c.b1, c.b2})
    if (value != 0.0) return true;
  for (const std::string* sigma : {&s.k1, &s.k2, &s.k3, &s.p1, &s.p2, &s.b1, &s.b2})
    if (*sigma != "held") return true;
  return false;
}
inline constexpr const char* distortion_fault = "there is or may be distortion, and it is not stated which point it is computed from";
inline constexpr const char* distortion_hint =
    "add distortion = \"ideal\" (OpenCV, COLMAP, Metashape) or distortion = \"measured\" (calibration protocols)";

template <>
struct Choices<DistortionAt> {
  static constexpr std::array<std::string_view, 2> names{"ideal", "measured"};
};

}  // namespace swath::core
