// SPDX-License-Identifier: GPL-3.0-or-later
// IMU and GNSS records and trajectories of a survey enter the run, and a trajectory leaves it.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/config/result.h"
#include "core/records/fix_counts.h"
#include "core/time.h"
#include "io/survey/survey.h"
#include "stages/once.h"
#include "trajectory/checks.h"

namespace swath::stages {

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

Given<core::ImuData, ImuFindings> read_imu(const io::Survey& survey, core::Tally& tally);
std::vector<std::filesystem::path> imu_files(const io::Survey& survey);
void expect_imu(const Context& context, const NoOptions&);

Given<core::GnssData, GnssFindings> read_gnss(const io::Survey& survey, core::Tally& tally);
std::vector<std::filesystem::path> gnss_files(const io::Survey& survey);
void expect_gnss(const Context& context, const NoOptions&);

Given<trajectory::Trajectory, trajectory::TrajectoryChecks> read_trajectory(const io::Survey& survey,
                                                                            const trajectory::TrajectoryOptions& o, core::Tally& tally);
std::vector<std::filesystem::path> trajectory_inputs(const io::Survey& survey);
void expect_trajectory(const Context& context, const trajectory::TrajectoryOptions&);

enum class TrajectoryOutput { sbet, text, covariance };

}  // namespace swath::stages

namespace swath::core {
template <>
struct Choices<stages::TrajectoryOutput> {
  static constexpr std::array<std::string_view, 3> names{"sbet", "text", "covariance"};
};
}  // namespace swath::core

namespace swath::stages {

struct TrajectoryWriteOptions {
  std::string name = "trajectory";
  std::vector<TrajectoryOutput> formats{TrajectoryOutput::sbet, TrajectoryOutput::text, TrajectoryOutput::covariance};
  core::TimeScale time = core::TimeScale::gps_week;
};

template <class V>
void describe(TrajectoryWriteOptions& o, V& v) {
  v.option("name", o.name, "Name of the files within the output, without ending.");
  v.option(
      "formats", o.formats,
      "sbet: NAME.sbet, and NAME.smrmsg with the standard deviations where the trajectory has them; text: NAME.csv, every record with its "
      "velocity and standard deviations; covariance: NAME_covariance.csv, the 9 x 9 covariance of position, velocity and attitude at the "
      "smoother's nodes (upper triangle), between which it is linear in time.");
  v.option("time", o.time, "Time scale of the text files (SBET: seconds of week).");
  v.check(!o.formats.empty(), "at least one format");
  v.check(o.time != core::TimeScale::unstated && o.time != core::TimeScale::device,
          "the time scale must be stated, and none of a device's own");
}

struct TrajectoryFiles {
  std::optional<int> sbet_gps_week{};
  std::uint64_t records = 0;
};

template <class V>
void describe(const TrajectoryFiles& r, V& v) {
  v.result("sbet_gps_week", r.sbet_gps_week, "GPS week that the seconds of the SBET file count from.");
  v.result("records", r.records, core::plain().in_summary(), "Records that were written.");
}

TrajectoryFiles write_trajectory(const trajectory::Trajectory& t, const Output& to, const TrajectoryWriteOptions& o, core::Tally& tally);
std::vector<std::string> trajectory_products(const TrajectoryWriteOptions& o);

}  // namespace swath::stages
