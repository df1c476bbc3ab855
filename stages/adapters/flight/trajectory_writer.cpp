// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/time.h"
#include "io/records/sbet.h"
#include "io/records/trajectory_text.h"
#include "stages/adapters/adapters.h"
#include "stages/once.h"

namespace swath::stages {

enum class TrajectoryOutput { sbet, text, covariance };

}  // namespace swath::stages

namespace swath::core {
template <>
struct Choices<stages::TrajectoryOutput> {
  static constexpr std::array<std::string_view, 3> names{"sbet", "text", "covariance"};
};
}  // namespace swath::core

namespace swath::stages {
namespace {

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

bool wants(const TrajectoryWriteOptions& o, TrajectoryOutput f) {
  return std::find(o.formats.begin(), o.formats.end(), f) != o.formats.end();
}

std::vector<std::string> trajectory_products(const TrajectoryWriteOptions& o) {
  std::vector<std::string> out;
  if (wants(o, TrajectoryOutput::sbet)) out.insert(out.end(), {o.name + ".sbet", o.name + ".smrmsg"});
  if (wants(o, TrajectoryOutput::text)) out.push_back(o.name + ".csv");
  if (wants(o, TrajectoryOutput::covariance)) out.push_back(o.name + "_covariance.csv");
  return out;
}

TrajectoryFiles write_trajectory(const trajectory::Trajectory& t, const Output& to, const TrajectoryWriteOptions& o, core::Tally& tally) {
  const core::TrajectoryData& data = t.data();
  const auto file = [&](const char* ending) { return to.folder / (o.name + ending); };
  TrajectoryFiles out;
  out.records = data.size();
  if (wants(o, TrajectoryOutput::sbet)) {
    io::write_sbet(file(".sbet"), data);
    if (data.has_sigma()) io::write_smrmsg(file(".smrmsg"), data);
    out.sbet_gps_week = core::week_of(data.time.front());
  }
  if (wants(o, TrajectoryOutput::text)) io::write_trajectory_text(file(".csv"), data, o.time);
  if (wants(o, TrajectoryOutput::covariance)) {
    if (data.covariance.empty())
      tally.count("the trajectory has no covariances: " + o.name + "_covariance.csv is not written");
    else
      io::write_covariance_text(file("_covariance.csv"), data, o.time);
  }
  return out;
}

}  // namespace

Entry trajectory_writer_stage() {
  return once<write_trajectory>("writers.trajectory", "Trajectory as SBET with smrmsg and as delimited text with its covariances.",
                                {.products = trajectory_products});
}

}  // namespace swath::stages
