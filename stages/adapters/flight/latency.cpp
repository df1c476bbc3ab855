// SPDX-License-Identifier: GPL-3.0-or-later
// The latency of a device whose places are compared with a trajectory.
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/option.h"
#include "core/error.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "stages/adapters/adapters.h"
#include "stages/once.h"
#include "trajectory/clock/latency.h"

namespace swath::stages {

enum class LatencyDevice { gnss, events };

}  // namespace swath::stages

namespace swath::core {
template <>
struct Choices<stages::LatencyDevice> {
  static constexpr std::array<std::string_view, 2> names{"gnss", "events"};
};
}  // namespace swath::core

namespace swath::stages {
namespace {

struct LatencyStageOptions : trajectory::LatencyOptions {
  LatencyDevice device = LatencyDevice::gnss;
};

template <class V>
void describe(LatencyStageOptions& o, V& v) {
  v.option("device", o.device, "What is late: GNSS fixes, or events whose places their recorder states (MRK).");
  describe(static_cast<trajectory::LatencyOptions&>(o), v);
}

/// The antenna at the trajectory's records, north, east, down about `origin`.
trajectory::Motion antenna_of(const trajectory::Trajectory& flown, const io::Antenna& antenna, const Eigen::Vector3d& origin,
                              double epoch) {
  const Eigen::Vector3d lever_arm(antenna.lever_arm[0].value, antenna.lever_arm[1].value, antenna.lever_arm[2].value);
  std::vector<double> time;
  std::vector<Eigen::Vector3d> place;
  for (const double t : flown.data().time)
    if (const auto pose = flown.pose_at(t)) {
      time.push_back(t);
      place.push_back(pose->position + pose->ecef_R_body * lever_arm);
    }
  return trajectory::places_of(time, place, origin, epoch);
}

trajectory::LatencyResult find_latency(const trajectory::Trajectory& flown, const core::GnssData* fixes, const core::EventData* events,
                                       const io::Survey& survey, const LatencyStageOptions& o, const Output& to, core::Tally& tally) {
  const bool of_fixes = o.device == LatencyDevice::gnss;
  if (of_fixes ? !fixes : !events)
    throw core::usage_error(of_fixes ? "time.latency: no GNSS fixes were read" : "time.latency: no events were read", survey.name,
                            of_fixes ? "put readers.gnss before it" : "put time.sync before it");
  const double epoch = std::floor(flown.data().time.front());
  const Eigen::Vector3d origin = flown.pose_at(flown.spans().front().first)->position;
  const trajectory::Motion device = of_fixes ? trajectory::places_of(fixes->time, fixes->position, origin, epoch)
                                             : trajectory::places_of(events->time, events->place, origin, epoch);
  if (device.time.empty())
    throw core::Error("time.latency: no event has a place", survey.name, "Timestamp.MRK files state places; other events do not");
  const trajectory::LatencyResult found = trajectory::latency_of_places(antenna_of(flown, survey.antenna, origin, epoch), device, o);
  if (!found.determinable) tally.count("latency not determinable", found.reason);
  io::write_text_file(to.folder / "latency.json", io::to_json(core::reported(found)));
  return found;
}

std::vector<std::string> latency_files(const LatencyStageOptions&) { return {"latency.json"}; }

}  // namespace

Entry latency_stage() {
  return once<find_latency>("time.latency",
                            "Latency of GNSS fixes or of events with places against a trajectory, with its sigma; or why it has none.",
                            {.products = latency_files});
}

}  // namespace swath::stages
