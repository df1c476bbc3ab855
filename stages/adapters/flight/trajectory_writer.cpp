// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/time.h"
#include "io/records/sbet.h"
#include "io/records/trajectory_text.h"
#include "stages/adapters/flight/navigation.h"

namespace swath::stages {
namespace {

bool wants(const TrajectoryWriteOptions& o, TrajectoryOutput f) {
  return std::find(o.formats.begin(), o.formats.end(), f) != o.formats.end();
}

}  // namespace

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

}  // namespace swath::stages
