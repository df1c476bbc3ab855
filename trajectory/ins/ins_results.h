// SPDX-License-Identifier: GPL-3.0-or-later
// What trajectory.json and the report hold of the smoother: each figure once.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/result.h"
#include "core/config/units.h"
#include "trajectory/clock/clock_offset.h"
#include "trajectory/compare.h"

namespace swath::trajectory {

struct SmootherSpan {
  double first = 0.0, last = 0.0;  ///< GPS time, s
  std::uint64_t records = 0, nodes = 0;
  int iterations = 0;
};

template <class V>
void describe(const SmootherSpan& r, V& v) {
  v.result("first_gps_s", r.first, core::seconds(), "GPS time of the first node.");
  v.result("last_gps_s", r.last, core::seconds(), "GPS time of the last node.");
  v.result("imu_records", r.records, "IMU records that were used.");
  v.result("nodes", r.nodes, "Instants that were estimated.");
  v.result("iterations", r.iterations, "Times that the smoother was repeated about its own result.");
}

/// A stretch without records of one kind.
struct Interruption {
  double start = 0.0, length = 0.0;  ///< GPS time, s
};

template <class V>
void describe(const Interruption& r, V& v) {
  v.result("start_gps_s", r.start, core::seconds(), "GPS time of its beginning.");
  v.result("length_s", r.length, core::seconds(), "Its length.");
}

struct AlignmentFound {
  std::string method;
  double time = 0.0, worst_sigma = 0.0;                                  ///< GPS time, s; rad
  std::optional<Eigen::Vector3d> given_minus_smoothed{}, given_sigma{};  ///< deg
};

template <class V>
void describe(const AlignmentFound& r, V& v) {
  using core::in_degrees;
  v.result("method", r.method, core::plain().in_summary(), "still, moving or given.");
  v.result("at_gps_s", r.time, core::seconds(), "GPS time of the first attitude.");
  v.result("worst_sigma_deg", r.worst_sigma / core::degree, in_degrees(3).always(), "Its sigma about the least known axis.");
  v.result("given_minus_smoothed_deg", r.given_minus_smoothed, in_degrees(3), "Given less smoothed roll, pitch, heading.");
  v.result("given_sigma_deg", r.given_sigma, in_degrees(3), "Sigmas of the given ones as stated.");
}

struct FixesUsed {
  std::uint64_t used = 0, down_weighted = 0;
  double correlated = 0.0, variance_factor = 1.0;
  std::optional<double> overstated{};
};

template <class V>
void describe(const FixesUsed& r, V& v) {
  v.result("used", r.used, core::plain().in_summary(), "Fixes that were used.");
  v.result("down_weighted", r.down_weighted, core::plain().in_summary(), "Of those: fixes that contradict the trajectory.");
  v.result("correlated_share", r.correlated, core::share(2), "Share of the fixes' variance that is correlated in time.");
  v.result("white_share", 1 - r.correlated, core::share(2), "Share that is not.");
  v.result("variance_factor", r.variance_factor, core::plain(2), "Factor on the stated covariances of the fixes.");
  v.result("sigmas_overstated", r.overstated, core::plain(1), "Times that the stated sigmas are too large by the scatter of the fixes.");
}

/// NIS of 3 degrees of freedom.
struct InnovationFigures {
  double mean = 0.0, band = 0.0;  ///< of the NIS; half width of its 95 % interval
  Eigen::Vector3d rms{0, 0, 0}, correlation{0, 0, 0}, residual_rms{0, 0, 0};
};

template <class V>
void describe(const InnovationFigures& r, V& v) {
  v.result("mean_nis", r.mean, core::plain(2).always(), "Mean normalised innovation squared of the fixes at full weight.");
  v.result("degrees_of_freedom", 3, "Degrees of freedom of the NIS, also its expected mean.");
  v.result("band_95", Eigen::Vector2d(3 - r.band, 3 + r.band), core::plain(2), "95 % interval of the mean NIS if the models are right.");
  v.result("rms_ned_m", r.rms, core::metres(), "RMS innovation: north, east, down.");
  v.result("correlation_lag_1_ned", r.correlation, core::plain(2), "Correlation of each innovation with the one before.");
  v.result("residual_rms_ned_m", r.residual_rms, core::metres(), "RMS of fix less smoothed antenna position.");
}

struct SeparationFigures {
  Eigen::Vector3d rms{0, 0, 0}, by_sigma{0, 0, 0}, attitude_rms{0, 0, 0};  ///< m; 1; arc seconds
  double median = 0.0, largest = 0.0;                                      ///< m
};

template <class V>
void describe(const SeparationFigures& r, V& v) {
  v.result("rms_ned_m", r.rms, core::metres(), "RMS separation: north, east, down.");
  v.result("by_its_sigma_ned", r.by_sigma, core::plain(2), "RMS of separation / its sigma.");
  v.result("median_m", r.median, core::metres().in_summary().always(), "Median distance.");
  v.result("largest_m", r.largest, core::metres().always(), "Largest distance.");
  v.result("rms_roll_pitch_heading_arcsec", r.attitude_rms, core::Form{"arcsec", 1}, "RMS separation of the attitude.");
}

/// A sensor constant at the middle of the record, with the sigma it was stated with; in `unit`.
struct SensorConstant {
  std::string_view name, unit_name;
  double unit = 1.0;
  Eigen::Vector3d value{0, 0, 0}, sigma{0, 0, 0};
  double stated = 0.0;
};

template <class V>
void describe(const SensorConstant& r, V& v) {
  v.result("unit", r.unit_name, "Unit of the figures.");
  v.result("value", Eigen::Vector3d(r.value / r.unit), "Estimate: x, y, z.");
  v.result("sigma", Eigen::Vector3d(r.sigma / r.unit), "Its sigmas.");
  v.result("stated_sigma", r.stated / r.unit, core::plain().always(), "Sigma stated in imu_spec.");
}

struct LeverArmFound {
  Eigen::Vector3d stated{0, 0, 0}, value{0, 0, 0}, sigma{0, 0, 0};
  double stated_sigma = 0.0;
};

template <class V>
void describe(const LeverArmFound& r, V& v) {
  v.result("unit", std::string_view("m"), "Unit of the figures.");
  v.result("stated", r.stated, core::metres(), "antenna.lever_arm: forward, right, down.");
  v.result("stated_sigma", r.stated_sigma, core::metres(), "antenna.lever_arm_sigma.");
  v.result("value", r.value, core::metres(), "Estimate.");
  v.result("sigma", r.sigma, core::metres(), "Its sigmas.");
}

struct LatencyFound {
  double value = 0.0, sigma = 0.0;  ///< s
};

template <class V>
void describe(const LatencyFound& r, V& v) {
  v.result("unit", std::string_view("s"), "Unit of the figures.");
  v.result("value", r.value, core::seconds(4).always(), "Estimate.");
  v.result("sigma", r.sigma, core::seconds(4).always(), "Its sigma.");
  v.result("meaning", std::string_view("to be added to the fixes' times"), "What the sign means.");
}

struct VehicleAxis {
  double azimuth = 0.0, elevation = 0.0, sigma = 0.0;  ///< rad
};

template <class V>
void describe(const VehicleAxis& r, V& v) {
  using core::in_degrees;
  v.result("unit", std::string_view("deg"), "Unit of the figures.");
  v.result("azimuth", r.azimuth / core::degree, in_degrees(3).always(), "Direction of travel in body axes, from x to y.");
  v.result("elevation", r.elevation / core::degree, in_degrees(3).always(), "The same, above the plane of x and y.");
  v.result("sigma", r.sigma / core::degree, in_degrees(3).always(), "Sigma of the azimuth.");
}

struct InsEstimates {
  SensorConstant gyro_bias{}, accelerometer_bias{};
  std::optional<SensorConstant> gyro_scale{}, accelerometer_scale{};
  std::optional<LeverArmFound> lever_arm{};
  std::optional<LatencyFound> latency{};
  std::optional<VehicleAxis> axis{};
};

template <class V>
void describe(const InsEstimates& r, V& v) {
  v.table("gyro_bias", r.gyro_bias, "Bias of the gyroscopes.");
  v.table("accelerometer_bias", r.accelerometer_bias, "Bias of the accelerometers.");
  v.table("gyro_scale", r.gyro_scale, "Scale error of the gyroscopes.");
  v.table("accelerometer_scale", r.accelerometer_scale, "Scale error of the accelerometers.");
  v.table("lever_arm", r.lever_arm, "Lever arm from the IMU to the antenna.");
  v.table("gnss_latency", r.latency, "Latency of the fixes.");
  v.table("vehicle_axis", r.axis, "Direction in which a land vehicle moves.");
}

struct SigmaFigures {
  Eigen::Vector3d position{0, 0, 0}, worst_position{0, 0, 0};  ///< m
  Eigen::Vector3d attitude{0, 0, 0}, worst_attitude{0, 0, 0};  ///< arc seconds
};

template <class V>
void describe(const SigmaFigures& r, V& v) {
  constexpr core::Form arcsec{"arcsec", 1};
  v.result("rms_ned_m", r.position, core::metres(), "RMS sigma of the position: north, east, down.");
  v.result("largest_ned_m", r.worst_position, core::metres(), "Largest sigmas.");
  v.result("rms_roll_pitch_heading_arcsec", r.attitude, arcsec, "RMS sigma of the attitude.");
  v.result("largest_roll_pitch_heading_arcsec", r.worst_attitude, arcsec, "Largest sigmas.");
}

/// What contradicts the survey's description: a warning of the run.
struct NamedFault {
  std::string_view code;
  std::string sentence;
};

template <class V>
void describe(const NamedFault& r, V& v) {
  v.result("code", r.code, "Code of the warning.");
  v.result("sentence", r.sentence, "What it is, with its figures.");
}

/// A step of the fixes' error.
struct StepFound {
  double first = 0.0;                                                               ///< GPS time of the first fix after it, s
  Eigen::Vector3d size = Eigen::Vector3d::Zero(), sigma = Eigen::Vector3d::Zero();  ///< north east down, m
};

template <class V>
void describe(const StepFound& r, V& v) {
  v.result("first_gps_s", r.first, core::seconds(), "GPS time of the first fix after it.");
  v.result("ned_m", r.size, core::metres(), "Its size: north, east, down.");
  v.result("sigma_ned_m", r.sigma, core::metres(), "Its sigmas.");
}

/// What the smoother found.
struct InsFigures {
  SmootherSpan span{};
  std::vector<Interruption> gaps{};
  ClockFindings clocks{};
  AlignmentFound alignment{};
  double standstill = 0.0;  ///< s
  FixesUsed fixes{};
  std::vector<StepFound> steps{};
  double imu_noise_factor = 1.0;
  std::vector<Interruption> outages{};
  InnovationFigures innovations{};
  std::optional<SeparationFigures> separation{};
  InsEstimates estimates{};
  SigmaFigures sigma{};
  double heading_smoothed_away = 0.0;  ///< arc seconds
  std::vector<NamedFault> named{};
  std::optional<TruthComparison> truth{};
};

template <class V>
void describe(const InsFigures& r, V& v) {
  v.table("span", r.span, "From the first node to the last.");
  v.tables("imu_gaps_bridged", r.gaps, "Gaps in the IMU records that were bridged.");
  v.table("clocks", r.clocks, "What the records show of their clocks.");
  v.table("alignment", r.alignment, "The first attitude.");
  v.result("standstill_s", r.standstill, core::seconds(1), "Time that the body stands still.");
  v.table("fixes", r.fixes, "The GNSS fixes.");
  v.tables("fix_steps", r.steps, "Steps of the fixes' error.");
  v.result("imu_noise_factor", r.imu_noise_factor, core::plain(1), "Factor on the stated noise of the IMU.");
  v.tables("outages", r.outages, "Stretches of 10 s or more without a fix.");
  v.table("innovations", r.innovations, "Fixes against the forward filter's prediction.");
  v.table("separation", r.separation, "Forward less backward solution.");
  v.table("estimates", r.estimates, "Errors of the sensors and of the mounting.");
  v.table("sigma", r.sigma, "Sigmas of the trajectory.");
  v.result("heading_smoothed_away_rms_arcsec", r.heading_smoothed_away, core::Form{"arcsec", 1}.always(),
           "RMS of the forward filter's heading less the smoothed one.");
  v.tables("named", r.named, "What contradicts the survey's description.");
  v.table("truth", r.truth, "Errors against the truth of a simulated survey.");
}

/// trajectory.json.
struct InsReport {
  InsFigures figures{};
  std::vector<std::string> warnings{};  ///< what a surveyor must look at, each with its numbers
};

template <class V>
void describe(const InsReport& r, V& v) {
  describe(r.figures, v);
  v.result("warnings", r.warnings, core::plain().in_summary(), "What to look at, as sentences with figures.");
}

}  // namespace swath::trajectory
