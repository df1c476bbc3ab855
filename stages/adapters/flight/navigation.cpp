// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/flight/navigation.h"

#include <algorithm>

#include "core/error.h"
#include "core/statistics.h"
#include "io/gnss/gnss_file.h"
#include "io/records/imu_file.h"
#include "io/records/trajectory_file.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

TimeSpan span_of(const std::vector<double>& time) {
  if (time.empty()) return {};
  return {core::utc_text(time.front()), core::utc_text(time.back()), time.back() - time.front()};
}

template <class File>
std::vector<fs::path> files_of(const io::Survey& survey, const std::vector<File>& files) {
  std::vector<fs::path> out;
  for (const File& f : files) out.push_back(io::resolve(survey, f.file));
  return out;
}

constexpr const char* trajectory_hint = "a survey with a given trajectory begins with readers.trajectory";

}  // namespace

std::vector<fs::path> imu_files(const io::Survey& survey) { return files_of(survey, survey.imu); }
void expect_imu(const Context& context, const NoOptions&) {
  if (context.survey.imu.empty())
    throw core::usage_error("readers.imu: the survey names no [[imu]] file", context.survey.name, trajectory_hint);
}
Given<core::ImuData, ImuFindings> read_imu(const io::Survey& survey, core::Tally& tally) {
  core::ImuData imu = io::read_imu(survey, tally);
  ImuFindings found{imu.size(), {}, span_of(imu.time)};
  if (imu.size()) found.rate = 1.0 / core::median(imu.step);
  return {std::move(imu), std::move(found)};
}

std::vector<fs::path> gnss_files(const io::Survey& survey) { return files_of(survey, survey.gnss); }
void expect_gnss(const Context& context, const NoOptions&) {
  if (context.survey.gnss.empty())
    throw core::usage_error("readers.gnss: the survey names no [[gnss]] file", context.survey.name, trajectory_hint);
}
Given<core::GnssData, GnssFindings> read_gnss(const io::Survey& survey, core::Tally& tally) {
  core::GnssData gnss = io::read_gnss(survey, tally);
  GnssFindings found{gnss.size(), span_of(gnss.time)};
  for (const core::FixQuality q : gnss.quality) {
    if (!found.quality) found.quality.emplace();
    found.quality->add(q);
  }
  if (gnss.has_velocity())
    found.with_velocity = std::count_if(gnss.velocity.begin(), gnss.velocity.end(), [](const Eigen::Vector3d& v) { return v.allFinite(); });
  return {std::move(gnss), std::move(found)};
}

std::vector<fs::path> trajectory_inputs(const io::Survey& survey) {
  std::vector<fs::path> out;
  for (const io::TrajectoryFile& f : io::trajectory_files(survey)) {
    out.push_back(io::resolve(survey, f.file));
    if (f.accuracy) out.push_back(io::resolve(survey, *f.accuracy));
  }
  return out;
}
void expect_trajectory(const Context& context, const trajectory::TrajectoryOptions&) {
  if (io::trajectory_files(context.survey).empty())
    throw core::usage_error(
        "readers.trajectory: the survey names no [[trajectory]]", context.survey.name,
        "IMU and GNSS records begin with readers.imu, readers.gnss and trajectory.ins_gnss; point clouds need no trajectory");
}
Given<trajectory::Trajectory, trajectory::TrajectoryChecks> read_trajectory(const io::Survey& survey,
                                                                            const trajectory::TrajectoryOptions& o, core::Tally& tally) {
  core::TrajectoryData data = io::read_trajectory(survey, tally);
  trajectory::CheckOptions checks;
  checks.max_gap = o.max_gap;
  trajectory::TrajectoryChecks found = trajectory::check_trajectory(data, checks);
  return {trajectory::Trajectory(std::move(data), o, io::trajectory_files(survey).front().file.string()), std::move(found)};
}

}  // namespace swath::stages
