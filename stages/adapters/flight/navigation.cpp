// SPDX-License-Identifier: GPL-3.0-or-later
// IMU and GNSS records and trajectories of a survey enter the run, and a trajectory leaves it.
#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/config/result.h"
#include "core/error.h"
#include "core/records/fix_counts.h"
#include "core/statistics.h"
#include "core/time.h"
#include "io/gnss/gnss_file.h"
#include "io/records/imu_file.h"
#include "io/records/trajectory_file.h"
#include "io/survey/survey.h"
#include "stages/adapters/adapters.h"
#include "stages/once.h"
#include "trajectory/checks.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

/// From the first record to the last.
struct TimeSpan {
  std::optional<std::string> first_utc{}, last_utc{};
  std::optional<double> seconds{};
};

template <class V>
void describe(const TimeSpan& r, V& v) {
  v.result("first_utc", r.first_utc, "UTC of the first record.");
  v.result("last_utc", r.last_utc, "UTC of the last record.");
  v.result("seconds", r.seconds, core::seconds(1).in_summary(), "Time from the first record to the last.");
}

struct ImuFindings {
  std::uint64_t records = 0;
  std::optional<double> rate{};
  TimeSpan span{};
};

template <class V>
void describe(const ImuFindings& r, V& v) {
  v.result("records", r.records, core::plain().in_summary(), "Records that were read.");
  v.result("rate_hz", r.rate, core::Form{"Hz", 1}.in_summary(), "Records per second, by the median step.");
  describe(r.span, v);
}

struct GnssFindings {
  std::uint64_t fixes = 0;
  TimeSpan span{};
  std::optional<core::FixCounts> quality{};
  std::optional<std::uint64_t> with_velocity{};
};

template <class V>
void describe(const GnssFindings& r, V& v) {
  v.result("fixes", r.fixes, core::plain().in_summary(), "Positions that were read.");
  describe(r.span, v);
  v.table("quality", r.quality, "Fixes by how they were computed.");
  v.result("with_velocity", r.with_velocity, "Fixes that state a velocity; absent where none does.");
}

TimeSpan span_of(const std::vector<double>& time) {
  if (time.empty()) return {};
  return {core::utc_text(time.front()), core::utc_text(time.back()), time.back() - time.front()};
}

constexpr const char* trajectory_hint = "a survey with a given trajectory begins with readers.trajectory";

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

}  // namespace

Entry trajectory_reader_stage() {
  return once<read_trajectory>("readers.trajectory",
                               "Reads the survey's trajectory and judges it: gaps, repeated times, heading against track.",
                               {.check = expect_trajectory, .inputs = trajectory_inputs});
}
Entry imu_reader_stage() {
  return once<read_imu>("readers.imu", "Reads the survey's IMU records as increments in body axes.",
                        {.check = expect_imu, .inputs = files_in<&io::Survey::imu>});
}
Entry gnss_reader_stage() {
  return once<read_gnss>("readers.gnss", "Reads the survey's GNSS positions (text, RTKLIB, NMEA).",
                         {.check = expect_gnss, .inputs = files_in<&io::Survey::gnss>});
}

}  // namespace swath::stages
