// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/flight/smoothing.h"

#include <algorithm>

#include "core/error.h"
#include "core/time.h"
#include "io/records/sbet.h"

namespace swath::stages {
namespace {

/// The clock offsets that the survey states, where one holds for all IMU files.
trajectory::StatedClocks clocks_of(const io::Survey& survey) {
  trajectory::StatedClocks out;
  out.antenna_latency = survey.antenna.latency.value;
  if (!survey.imu.empty()) out.imu_offset = survey.imu.front().time.offset.value;
  for (const io::ImuFile& f : survey.imu)
    if (out.imu_offset && f.time.offset.value != *out.imu_offset) out.imu_offset.reset();
  return out;
}

}  // namespace

double smoother_nodes(const core::ImuData& imu, const trajectory::InsGnssOptions& o) {
  return imu.size() > 1 ? (imu.time.back() - imu.time.front()) / o.node_spacing.value : 0.0;
}

double smoothing_memory(const core::ImuData& imu, const trajectory::InsGnssOptions& o) {
  constexpr double bytes_per_record = 162.0, bytes_per_node = 11e3, nodes_at_once = 20000.0;
  return bytes_per_record * static_cast<double>(imu.size()) + bytes_per_node * std::min(smoother_nodes(imu, o), nodes_at_once);
}

void require_imu_spec(const io::Survey& survey, const std::string& stage) {
  const core::ImuSpec& spec = survey.imu_spec;
  if (spec.grade == core::ImuGrade::unstated &&
      !(spec.angular_random_walk && spec.velocity_random_walk && spec.gyro_bias && spec.accelerometer_bias))
    throw core::usage_error(stage + ": the survey does not say how good the IMU is", survey.name,
                            "state imu_spec.grade, or in [imu_spec] at least the two random walks and the two biases of its data sheet");
}

trajectory::InsGnssResult smooth_records(core::ImuData imu, const core::GnssData& gnss, const io::Survey& survey,
                                         const trajectory::InsGnssOptions& options, const core::OnProgress& progress,
                                         trajectory::SmoothedFlight* left) {
  const io::Antenna& antenna = survey.antenna;
  const Eigen::Vector3d lever_arm(antenna.lever_arm[0].value, antenna.lever_arm[1].value, antenna.lever_arm[2].value);
  return trajectory::smooth(std::move(imu), gnss, survey.imu_spec.model(), lever_arm, antenna.lever_arm_sigma.value, options,
                            clocks_of(survey), progress, left);
}

trajectory::Trajectory as_flown(core::TrajectoryData data, double rate, const std::string& where) {
  trajectory::TrajectoryOptions interpolation;
  constexpr double steps = 2.5;  // of the trajectory's records; a longer one is a gap
  interpolation.max_gap.value = std::max(interpolation.max_gap.value, steps / rate);
  return trajectory::Trajectory(std::move(data), interpolation, where);
}

std::optional<trajectory::Trajectory> truth_of(const io::Survey& survey, const core::TrajectoryData& flown) {
  if (!survey.truth.trajectory || flown.size() == 0) return std::nullopt;
  const std::filesystem::path file = io::resolve(survey, *survey.truth.trajectory);
  // An SBET, whose seconds of week are of the week that the flight begins in.
  const io::TimeTags time{core::TimeScale::gps_week, core::week_of(flown.time.front()), {}};
  core::Tally ignored;
  return trajectory::Trajectory(io::read_sbet(file, time, true, io::VelocityAxes::ignore, std::nullopt, ignored), {}, file.string());
}

std::vector<std::filesystem::path> true_trajectory(const io::Survey& survey) {
  if (!survey.truth.trajectory) return {};
  return {io::resolve(survey, *survey.truth.trajectory)};
}

trajectory::TruthComparison compare_with_truth(const io::Survey& survey, const core::TrajectoryErrors& errors) {
  trajectory::TruthComparison out{errors.outside, trajectory::compare(errors)};
  std::vector<trajectory::Span> lines;
  for (const io::LineWindow& w : io::line_windows(survey)) lines.push_back({w.start, w.end});
  if (!lines.empty()) out.lines = trajectory::compare(errors, lines);
  return out;
}

}  // namespace swath::stages
