// SPDX-License-Identifier: GPL-3.0-or-later
// What is simulated: the one declaration of each option of `swath simulate`.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/records/sensor.h"
#include "core/time.h"
#include "io/survey/survey.h"
#include "simulate/camera_options.h"
#include "simulate/flight_options.h"
#include "simulate/navigation_options.h"
#include "simulate/scene_options.h"

namespace swath::simulate {

/// How the beam moves.
enum class Pattern { triangle, sine, polygon, profile, beam, multibeam, conical, palmer };

struct ScannerOptions {
  Pattern pattern = Pattern::triangle;
  core::Hertz prf{16000.0};
  core::Hertz frequency{25.0};
  core::Radians half_angle = core::degrees(20.0);
  core::Radians forward_tilt = core::degrees(8.0);
  core::Radians shaft_angle = core::degrees(45.0), mirror_tilt = core::degrees(7.0);
  core::Radians divergence{0.3e-3};
  int beams = 32;
  int max_returns = 4;
  core::Metres separation{1.2};
  core::Metres range_resolution{0.001};
  core::Radians angle_resolution = core::degrees(0.0002);
};

template <class V>
void describe(ScannerOptions& s, V& v) {
  v.option(
      "pattern", s.pattern,
      "Motion of the beam: oscillating mirror (triangle, sine), one-way polygon, profile (no scan), beam (a triangle scan that nods "
      "forward, recorded as vectors), multibeam (a fan of beams along the track that a head turns across, recorded as vectors), conical, "
      "palmer.");
  v.option("prf", s.prf, core::within(10, 2e6), "Pulses per second.");
  v.option("frequency", s.frequency, core::within(0.1, 1000), "Full scans (there and back, or turns, or facets) per second.");
  v.option("half_angle", s.half_angle, core::within(0.005, 0.9), "Half of the field of view; half angle of the cone (conical).");
  v.option("forward_tilt", s.forward_tilt, core::within(0, 0.6), "Amplitude of the nod (beam); half of the fan (multibeam).");
  v.option("beams", s.beams, core::within(2, 128), "Beams of the fan, fired one after the other (multibeam).");
  v.option("shaft_angle", s.shaft_angle, core::within(0.1, 1.5), "Between the mirror's shaft and the nadir axis (palmer).");
  v.option("mirror_tilt", s.mirror_tilt, core::above_to(0.0, 0.3), "Between the mirror's normal and its shaft (palmer).");
  v.option("divergence", s.divergence, core::within(0, 0.01),
           "Full divergence of the beam (1/e2); a quarter of it is the sigma of the echo along and across.", "Schaer2007");
  v.option("max_returns", s.max_returns, core::within(1, 4), "Returns recorded of one pulse: the first ones and the last.");
  v.option("separation", s.separation, core::within(0, 20), "A return nearer than this behind another is lost.");
  v.option("range_resolution", s.range_resolution, core::within(0, 1), "Step of recorded ranges (0: none).");
  v.option("angle_resolution", s.angle_resolution, core::within(0, 0.01), "Step of recorded angles (0: none).");
}

struct NoiseOptions {
  bool noise_free = false;
  core::Metres range{0.015};
  core::Radians scan_angle = core::degrees(0.001);
  core::Metres horizontal{0.02}, vertical{0.03};
  core::Radians roll_pitch = core::degrees(0.0025), heading = core::degrees(0.005);
  core::Seconds correlation{60.0};
  core::Metres line_shift, line_drift;
  core::Radians line_attitude, line_attitude_drift;
  double high_points = 2e-5, low_points = 2e-5, multipath = 5e-5;
  double low_groups = 0.0;
};

template <class V>
void describe(NoiseOptions& n, V& v) {
  v.option("noise_free", n.noise_free, "No noise, no errors, no outliers, no rounding to resolutions, a beam without width.");
  v.option("range", n.range, core::within(0, 1), "Sigma of one range.");
  v.option("scan_angle", n.scan_angle, core::within(0, 0.01), "Sigma of one scan angle.");
  v.option("horizontal", n.horizontal, core::within(0, 10), "Sigma of the delivered trajectory, north and east each.");
  v.option("vertical", n.vertical, core::within(0, 10), "Sigma of the delivered trajectory's height.");
  v.option("roll_pitch", n.roll_pitch, core::within(0, 0.02), "Sigma of the delivered roll and pitch.");
  v.option("heading", n.heading, core::within(0, 0.02), "Sigma of the delivered heading.");
  v.option("correlation", n.correlation, core::within(0.5, 3600), "Correlation time of the delivered trajectory's errors.");
  v.option("line_shift", n.line_shift, core::within(0, 10),
           "Sigma of the delivered trajectory's offset on a whole line, sampled for each line and axis.");
  v.option("line_drift", n.line_drift, core::within(0, 10), "Sigma of its linear change from the line's start to its end, for each axis.");
  v.option("line_attitude", n.line_attitude, core::within(0, 0.02), "Sigma of such an offset of roll, pitch and heading.");
  v.option("line_attitude_drift", n.line_attitude_drift, core::within(0, 0.02), "Sigma of the change of that offset along the line.");
  v.option("high_points", n.high_points, core::within(0, 0.1), "Share of pulses whose first return is an isolated high point (class 18).");
  v.option("low_points", n.low_points, core::within(0, 0.1),
           "Share of pulses whose last return is an isolated low point, 3 to 25 m late (class 7).");
  v.option("multipath", n.multipath, core::within(0, 0.1), "Share of pulses whose last return comes 0.5 to 3 m late (class 7).");
  v.option("low_groups", n.low_groups, core::within(0, 100),
           "Groups of low points (class 7) per hectare, within 1.5 m of a place, 1 to 6 m deep.");
}

/// What survey.toml says of the calibration.
enum class Deliver {
  truth,    ///< the true values
  drawn,    ///< the true values with errors drawn from their stated sigmas
  nominal,  ///< the mounting as measured: lever arm with its drawn error, everything else as on the drawing board (0, scale 1)
};

struct CalibrationSigma {
  core::Radians roll, pitch, heading;
  core::Metres lever_arm, range_offset;
  double range_scale = 0.0;
  core::Radians scan_offset;
  double scan_scale = 0.0;
  core::Seconds latency;
};

template <class V>
void describe(CalibrationSigma& s, V& v) {
  v.option("roll", s.roll, core::at_least(0), "Sigma of the boresight roll.");
  v.option("pitch", s.pitch, core::at_least(0), "Sigma of the boresight pitch.");
  v.option("heading", s.heading, core::at_least(0), "Sigma of the boresight heading.");
  v.option("lever_arm", s.lever_arm, core::at_least(0), "Sigma of each component of the lever arm.");
  v.option("range_offset", s.range_offset, core::at_least(0), "Sigma of the range offset.");
  v.option("range_scale", s.range_scale, core::at_least(0), "Sigma of the range scale.");
  v.option("scan_offset", s.scan_offset, core::at_least(0), "Sigma of the scan offset.");
  v.option("scan_scale", s.scan_scale, core::at_least(0), "Sigma of the scan scale.");
  v.option("latency", s.latency, core::at_least(0), "Sigma of the latency.");
}

/// The calibration of the README's survey: a boresight that shows, a range offset, a scan scale.
core::Calibration default_calibration();
CalibrationSigma default_drawn_sigma();
CalibrationSigma default_nominal_sigma();

struct MountingOptions {
  core::Calibration truth = default_calibration();
  Deliver deliver = Deliver::drawn;
  CalibrationSigma sigma = default_drawn_sigma();
  CalibrationSigma nominal_sigma = default_nominal_sigma();
  core::Radians random_boresight;
  core::Metres random_range_offset;
  double random_scan_scale = 0.0;
  std::array<core::Metres, 3> lever_arm_antenna{core::Metres(-0.412), core::Metres(0.127), core::Metres(-1.236)};
};

template <class V>
void describe(MountingOptions& m, V& v) {
  v.table("truth", m.truth, "True calibration.");
  v.option("deliver", m.deliver, "Calibration in survey.toml: truth, drawn (errors from `sigma`) or nominal (uncalibrated).");
  v.table("sigma", m.sigma, "Sigmas that errors are drawn from and that survey.toml states (drawn; lever arm also for nominal).");
  v.table("nominal_sigma", m.nominal_sigma,
          "Sigmas that survey.toml states for a nominal calibration; for what is drawn by a random_ option the sigma of that draw.");
  v.option("random_boresight", m.random_boresight, core::within(0, 0.1),
           "Adds to the true roll, pitch and heading what the seed draws, evenly within plus and minus this.");
  v.option("random_range_offset", m.random_range_offset, core::within(0, 10), "Adds to the true range offset a draw of this sigma.");
  v.option("random_scan_scale", m.random_scan_scale, core::within(0, 0.01), "Adds to the true scan scale a draw of this sigma.");
  v.option("lever_arm_antenna", m.lever_arm_antenna, "IMU centre to GNSS antenna: forward, right, down.");
}

enum class Format { csv, npy, las, laz };
enum class TrajectoryOutput { sbet, text, none };

struct OutputOptions {
  bool laser = true;
  std::vector<Format> formats{Format::npy};
  TrajectoryOutput trajectory = TrajectoryOutput::sbet;
  core::TimeScale time = core::TimeScale::gps_week;
  int week = 2317;
  core::Seconds start{474000.0};
  bool truth_returns = true;
  core::Metres dtm_cell{1.0};
};

template <class V>
void describe(OutputOptions& o, V& v) {
  v.option("laser", o.laser, "Laser records and their world; without them navigation records are written alone, in seconds.");
  v.option("formats", o.formats, "Formats of the raw laser records; survey.toml names the first, survey_FORMAT.toml the others.");
  v.option("trajectory", o.trajectory, "Format of the delivered trajectory: SBET with smrmsg, or text; none: IMU and GNSS only.");
  v.option("time", o.time, "Time scale of laser and text records (SBET, imu.csv and gnss.csv: always seconds of week).");
  v.option("week", o.week, core::within(0, 5000), "GPS week of the start (flights along a trajectory: that of its first record).");
  v.option("start", o.start, core::within(0, core::seconds_per_week - 1),
           "Seconds of week of the start (flights along a trajectory: its first record).");
  v.option("truth_returns", o.truth_returns, "Writes truth/returns.npy (105 bytes a return).");
  v.option("dtm_cell", o.dtm_cell, core::within(0.1, 100), "Cell of truth/dtm.tif.");
  v.check(o.time != core::TimeScale::unstated && o.time != core::TimeScale::device,
          "the time scale must be stated, and none of a device's own");
  v.check(!o.formats.empty(), "at least one format; `laser = false` for none");
}

struct Options {
  std::int64_t seed = 1;
  std::string name = "simulated";
  std::string crs = "EPSG:32632";
  core::Radians latitude = core::degrees(47.906), longitude = core::degrees(10.512);
  WorldOptions world;
  FlightOptions flight;
  ScannerOptions scanner;
  NoiseOptions noise;
  MountingOptions mounting;
  ImuOptions imu;
  GnssOptions gnss;
  EventOptions events;
  CameraOptions camera;
  ControlOptions control;
  OutputOptions output;
};

template <class V>
void describe(Options& o, V& v) {
  v.option("seed", o.seed, core::at_least(0), "Everything random follows from it.");
  v.option("name", o.name, "Name of the survey.");
  v.option("crs", o.crs, "Projected CRS of the map, in metres, ellipsoidal heights.");
  v.option("latitude", o.latitude, core::within(-1.45, 1.45), "Latitude of the middle of the area.");
  v.option("longitude", o.longitude, core::within(-core::pi, core::pi), "Longitude of the middle of the area.");
  v.table("world", o.world, "Ground and objects.");
  v.table("flight", o.flight, "Flight.");
  v.table("scanner", o.scanner, "Scanner.");
  v.table("noise", o.noise, "Noise and outliers.");
  v.table("mounting", o.mounting, "Calibration, true and delivered.");
  v.table("imu", o.imu, "IMU.");
  v.table("gnss", o.gnss, "GNSS receiver.");
  v.table("events", o.events, "Camera exposures and the computer clock that times them.");
  v.table("camera", o.camera, "Camera whose exposures are the events.");
  v.table("control", o.control, "Surveyed points and targets, of surveys with laser records.");
  v.table("output", o.output, "Files.");
  const bool parks = o.scanner.pattern == Pattern::triangle || o.scanner.pattern == Pattern::sine;
  v.check(o.flight.pattern != FlightPattern::calibration || !o.flight.profile_lines || parks,
          "only an oscillating mirror (triangle, sine) can stand still at nadir: set flight.profile_lines = false");
  v.check(o.flight.along.empty() || !o.output.laser, "a flight along a trajectory has no laser: set output.laser = false");
  v.check(o.output.trajectory != TrajectoryOutput::none || (o.imu.file && o.gnss.file),
          "without a trajectory the survey needs imu.file and gnss.file");
  v.check(!o.camera.photos || o.camera.file, "camera.photos needs camera.file = true");
  v.check(!o.camera.file || (o.events.file && o.flight.along.empty()), "camera.file needs events.file = true and a flight along lines");
  bool las = false;
  for (Format f : o.output.formats) las = las || f == Format::las || f == Format::laz;
  v.check(!las || (o.scanner.pattern != Pattern::conical && o.scanner.pattern != Pattern::palmer),
          "LAS and LAZ hold coordinates, not the encoder angle of a conical or palmer scanner: choose csv or npy");
}

/// The scanner model that calib uses for a pattern.
core::ScannerModel model_of(Pattern p);

}  // namespace swath::simulate

namespace swath::core {
template <>
struct Choices<simulate::Pattern> {
  static constexpr std::array<std::string_view, 8> names{"triangle", "sine",      "polygon", "profile",
                                                         "beam",     "multibeam", "conical", "palmer"};
};
template <>
struct Choices<simulate::Deliver> {
  static constexpr std::array<std::string_view, 3> names{"truth", "drawn", "nominal"};
};
template <>
struct Choices<simulate::Format> {
  static constexpr std::array<std::string_view, 4> names{"csv", "npy", "las", "laz"};
};
template <>
struct Choices<simulate::TrajectoryOutput> {
  static constexpr std::array<std::string_view, 3> names{"sbet", "text", "none"};
};
}  // namespace swath::core
