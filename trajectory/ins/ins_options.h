// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "core/config/option.h"

namespace swath::trajectory {

enum class AlignmentMethod { automatic, given, still, moving };

/// Attitude at the first IMU record, where it is known.
struct GivenAttitude {
  core::Radians roll, pitch, heading;
  core::Radians sigma_roll_pitch = core::degrees(1.0), sigma_heading = core::degrees(5.0);
};

template <class V>
void describe(GivenAttitude& a, V& v) {
  v.option("roll", a.roll, core::one_turn(), "Roll at the first IMU record used, which lies at most 120 s before the first fix.");
  v.option("pitch", a.pitch, core::within(-0.5 * core::pi, 0.5 * core::pi),
           "Pitch at the first IMU record used, which lies at most 120 s before the first fix.");
  v.option("heading", a.heading, core::one_turn(), "Heading at the first IMU record used, which lies at most 120 s before the first fix.");
  v.option("sigma_roll_pitch", a.sigma_roll_pitch, core::above(0), "Sigma of roll and of pitch.");
  v.option("sigma_heading", a.sigma_heading, core::above(0), "Sigma of heading.");
}

struct InsGnssOptions {
  AlignmentMethod alignment = AlignmentMethod::automatic;
  GivenAttitude given;
  bool scale_factors = true, lever_arm = true, gnss_latency = false;
  std::optional<double> correlated_share;
  core::Seconds correlation_time{120.0};
  core::Seconds latency_sigma{0.005};
  core::Seconds clock_search{2.0};
  bool use_velocity = true;
  double outlier_probability = 1e-4;
  bool zero_velocity = true;
  bool non_holonomic = false;
  core::MetresPerSecond non_holonomic_sigma{0.1};
  std::array<core::Metres, 3> wheel_point{};
  core::Seconds max_gap{10.0};
  core::Hertz output_rate{200.0};
  core::Seconds error_spacing{1.0};
  core::Seconds node_spacing{0.25};
};

template <class V>
void describe(InsGnssOptions& o, V& v) {
  v.option("alignment", o.alignment, "Initial attitude: given, still (levelling, gyrocompassing), moving (GNSS in motion) or automatic.");
  v.table("given", o.given, "Attitude to begin with (alignment given), used with its sigmas.");
  v.option("scale_factors", o.scale_factors, "Estimate scale factors of gyros and accelerometers.");
  v.option("lever_arm", o.lever_arm, "Estimate the antenna's lever arm about its stated value and sigma.");
  v.option("gnss_latency", o.gnss_latency, "Estimate a constant time offset of the GNSS fixes.");
  v.option("correlated_share", o.correlated_share, core::within(0, 0.95),
           "Share of the stated GNSS variance that is correlated in time; without a value: estimated.");
  v.option("correlation_time", o.correlation_time, core::above(0), "Correlation time of that part.");
  v.option("latency_sigma", o.latency_sigma, core::above(0), "Sigma of the time offset before it is estimated.");
  v.option("clock_search", o.clock_search, core::within(0, 30),
           "Largest offset between IMU and GNSS clocks that is looked for; 0: none is.");
  v.option("use_velocity", o.use_velocity, "Use GNSS velocities where the fixes have them and they do not lag behind the positions.");
  v.option("outlier_probability", o.outlier_probability, core::above_to(0, 0.05),
           "A fix whose innovation is less probable than this is down-weighted and counted.");
  v.option("zero_velocity", o.zero_velocity, "Use standstill on the ground, where IMU and GNSS show it.");
  v.option("non_holonomic", o.non_holonomic, "Wheeled vehicle: it moves along its own forward axis only.");
  v.option("non_holonomic_sigma", o.non_holonomic_sigma, core::above(0), "Sigma of the velocities across and up (non_holonomic).");
  v.option("wheel_point", o.wheel_point, "IMU centre to the point that does not slip sideways, the rear axle: forward, right, down.");
  v.option("max_gap", o.max_gap, core::within(0, 30), "Longest gap in the IMU records that is bridged; a longer one is an error.");
  v.option("output_rate", o.output_rate, core::within(20, 2000), "Records per second of the trajectory, where the IMU has more.");
  v.option("error_spacing", o.error_spacing, core::within(0, 60),
           "Spacing at which error correlations in time are kept, for adjustments (30 MB/h at 1 s); 0: none.", "Jong1988");
  v.option("node_spacing", o.node_spacing, core::within(0.05, 2),
           "Maximum time between two instants with a state of their own; each fix is one.");
}

}  // namespace swath::trajectory

namespace swath::core {
template <>
struct Choices<trajectory::AlignmentMethod> {
  static constexpr std::array<std::string_view, 4> names{"automatic", "given", "still", "moving"};
};
}  // namespace swath::core
