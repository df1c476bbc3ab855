// SPDX-License-Identifier: GPL-3.0-or-later
// What a survey says of its scanner: the model of its beam, its calibration and how well each value is known.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/option.h"

namespace swath::core {

/// How a recorded angle becomes a beam in the scanner frame (x forward, y right, z nadir).
enum class ScannerModel {
  mirror,   ///< oscillating mirror, scans across: (0, sin a', cos a')
  polygon,  ///< rotating polygon: same geometry, one way
  profile,  ///< no scan: a' = a0
  beam,     ///< general vector given per record (SOCS x, y, z)
  conical,  ///< a' turns about the nadir axis at the cone's half angle: (sin c cos a', sin c sin a', cos c)
  palmer,   ///< rotating tilted mirror: reflection of a fixed beam, elliptical scan (see georef/beam.h)
};

/// Calibration of the scanner on its carrier (conventions.md): a' = s_a a + a0, r' = s_r r + r0, t = t_record + latency,
/// body_R_scanner = Rz(heading) Ry(pitch) Rx(roll).
struct Calibration {
  Radians roll, pitch, heading;               ///< boresight
  std::array<Metres, 3> lever_arm_scanner{};  ///< body frame, from the IMU's centre
  Metres range_offset;
  double range_scale = 1.0;
  Radians scan_offset;
  double scan_scale = 1.0;
  Seconds latency;
};

template <class V>
void describe(Calibration& c, V& v) {
  v.option("roll", c.roll, one_turn(), "Boresight roll, positive right wing down.", "conventions");
  v.option("pitch", c.pitch, one_turn(), "Boresight pitch, positive nose up.", "conventions");
  v.option("heading", c.heading, one_turn(), "Boresight heading, clockwise seen from above.", "conventions");
  v.option("lever_arm_scanner", c.lever_arm_scanner, "IMU centre to scanner origin: forward, right, down.", "conventions");
  v.option("range_offset", c.range_offset, "Added to every recorded range.");
  v.option("range_scale", c.range_scale, within(0.5, 2.0), "Factor on every recorded range.");
  v.option("scan_offset", c.scan_offset, one_turn(), "Added to every scaled scan angle.");
  v.option("scan_scale", c.scan_scale, within(0.5, 2.0), "Factor on every recorded scan angle.");
  v.option("latency", c.latency, "Added to every record's time.");
}

/// The calibration values as files name them, in the order of SensorSigma::correlation.
inline constexpr std::array<std::string_view, 11> calibration_keys{
    "boresight_roll", "boresight_pitch", "boresight_heading", "lever_forward", "lever_right", "lever_down",
    "range_offset",   "range_scale",     "scan_offset",       "scan_scale",    "latency"};

/// One-sigma uncertainties of the calibration and of the single record: what the TPU is made of.
struct SensorSigma {
  Radians roll = degrees(0.005), pitch = degrees(0.005), heading = degrees(0.01);
  Metres lever_arm{0.01};
  Metres range_offset{0.0};
  double range_scale = 0.0;
  Radians scan_offset;
  double scan_scale = 0.0;
  Seconds latency;
  Metres range{0.02};
  Radians scan_angle = degrees(0.001);
  Seconds time;
  Radians beam_divergence;  ///< full angle (1/e2)
  /// Keys of these that a survey or its calibration file states; the others are the defaults above.
  std::vector<std::string> stated;
  /// Correlations of the errors of the calibration values, 11 x 11 row by row in the order of calibration_keys. Empty: none are known.
  std::vector<double> correlation;
};

template <class V>
void describe(SensorSigma& s, V& v) {
  v.option("roll", s.roll, at_least(0), "Sigma of the boresight roll.");
  v.option("pitch", s.pitch, at_least(0), "Sigma of the boresight pitch.");
  v.option("heading", s.heading, at_least(0), "Sigma of the boresight heading.");
  v.option("lever_arm", s.lever_arm, at_least(0), "Sigma of each component of the scanner's lever arm.");
  v.option("range_offset", s.range_offset, at_least(0), "Sigma of the range offset.");
  v.option("range_scale", s.range_scale, at_least(0), "Sigma of the range scale.");
  v.option("scan_offset", s.scan_offset, at_least(0), "Sigma of the scan angle offset.");
  v.option("scan_scale", s.scan_scale, at_least(0), "Sigma of the scan angle scale.");
  v.option("latency", s.latency, at_least(0), "Sigma of the latency.");
  v.option("range", s.range, at_least(0), "Sigma of one range.");
  v.option("scan_angle", s.scan_angle, at_least(0), "Sigma of one scan angle.");
  v.option("time", s.time, at_least(0), "Sigma of one time tag.");
  v.option("beam_divergence", s.beam_divergence, at_least(0), "Full divergence of the beam; a quarter of it acts as pointing sigma.",
           "Schaer2007");
}

/// Temperature, pressure and humidity at one height.
struct Air {
  Kelvin temperature{288.15};
  Pascals pressure{101325.0};
  double humidity = 0.5;  ///< relative, 0 to 1
};

template <class V>
void describe(Air& a, V& v) {
  v.option("temperature", a.temperature, within(180.0, 340.0), "Air temperature.");
  v.option("pressure", a.pressure, within(1e4, 1.2e5), "Air pressure.");
  v.option("humidity", a.humidity, within(0.0, 1.0), "Relative humidity, 0 to 1.");
}

enum class AirModel { none, ciddor };

/// The scanner of a survey.
struct Scanner {
  ScannerModel model = ScannerModel::mirror;
  Radians cone_angle = degrees(20.0);   ///< conical: half angle of the cone
  Radians shaft_angle = degrees(45.0);  ///< palmer: between the shaft and the nadir axis, in the x-z plane
  Radians mirror_tilt = degrees(7.0);   ///< palmer: between the shaft and the mirror's normal
  AirModel air = AirModel::none;
  Metres wavelength{1064e-9};
  double group_index = 1.0;  ///< index of refraction that the recorded ranges were already reduced with
  Air at_sensor, at_ground;
};

template <>
struct Choices<ScannerModel> {
  static constexpr std::array<std::string_view, 6> names{"mirror", "polygon", "profile", "beam", "conical", "palmer"};
};
template <>
struct Choices<AirModel> {
  static constexpr std::array<std::string_view, 2> names{"none", "ciddor"};
};

template <class V>
void describe(Scanner& s, V& v) {
  v.option("model", s.model, "How a recorded angle becomes a beam.");
  v.option("cone_angle", s.cone_angle, above_to(0.0, 1.3), "Half angle of the cone (conical).");
  v.option("shaft_angle", s.shaft_angle, within(0.1, 1.5), "Between the mirror's shaft and the nadir axis (palmer).");
  v.option("mirror_tilt", s.mirror_tilt, above_to(0.0, 0.7), "Between the mirror's normal and its shaft (palmer).");
  v.option("air", s.air, "Atmospheric correction of range and refraction of the beam.", "Ciddor1996");
  v.option("wavelength", s.wavelength, within(300e-9, 2000e-9), "Of the laser.");
  v.option("group_index", s.group_index, within(1.0, 1.001), "Group index that the recorded ranges already hold (1 = vacuum).");
  v.table("at_sensor", s.at_sensor, "Air at the scanner.");
  v.table("at_ground", s.at_ground, "Air at the ground.");
}

}  // namespace swath::core
