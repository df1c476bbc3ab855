// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/trajectory_faults.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/records/trajectory_columns.h"
#include "core/time.h"
#include "io/survey/wild_records.h"

namespace swath::io {
namespace {

constexpr double max_apart = 3600.0;           // s
constexpr double highest_flight = 100e3;       // m
constexpr double fastest = 500.0;              // m/s
constexpr double near = 100.0;                 // m: what a position may be off by
constexpr double impossible_speed = 1000.0;    // m/s
constexpr double max_turns = 4 * core::pi;     // rad: angles are written within one turn, by some within two
constexpr double turn = 0.5, turn_rate = 3.0;  // rad, rad/s
constexpr double steep_pitch = core::pi / 3;   // rad: pitch beyond which roll and heading are not well determined

/// Name of the first column whose value is not finite; empty where all are.
std::string not_finite(const core::TrajectoryData& t, size_t i) {
  std::string first;
  core::for_each_trajectory_column([&](auto member, const char* name) {
    const auto& column = t.*member;
    if (first.empty() && !column.empty() && !std::isfinite(column[i])) first = name;
  });
  return first;
}

bool is_possible(const core::TrajectoryData& t, size_t i) {
  const auto angle = [&](const std::vector<double>& a) { return std::abs(a[i]) <= max_turns; };
  const bool slow = !t.has_velocity() || std::hypot(t.v_north[i], t.v_east[i], t.v_down[i]) < impossible_speed;
  return std::abs(t.latitude[i]) <= core::pi / 2 && std::abs(t.pitch[i]) <= core::pi / 2 && t.height[i] > lowest_height &&
         t.height[i] < highest_flight && angle(t.longitude) && angle(t.roll) && angle(t.heading) && slow;
}

/// "roll 1e+300 deg": what pose_faults() found impossible or not finite.
std::string value_text(const core::TrajectoryData& t, size_t i) {
  if (const std::string name = not_finite(t, i); !name.empty()) return name + " is not finite";
  const auto degrees = [](double v) { return core::format_number(std::round(core::to_degrees(v) * 1e6) / 1e6) + " deg"; };
  std::string text = "latitude " + degrees(t.latitude[i]) + ", longitude " + degrees(t.longitude[i]) + ", height " +
                     core::format_number(t.height[i], 6) + " m, roll " + degrees(t.roll[i]) + ", pitch " + degrees(t.pitch[i]) +
                     ", heading " + degrees(t.heading[i]);
  if (t.has_velocity()) text += ", speed " + core::format_number(std::hypot(t.v_north[i], t.v_east[i], t.v_down[i]), 4) + " m/s";
  return text;
}

}  // namespace

std::vector<PoseFault> pose_faults(const core::TrajectoryData& t) {
  std::vector<PoseFault> out(t.size(), PoseFault::none);
  std::vector<size_t> good;
  for (size_t i = 0; i < t.size(); ++i) {
    if (!not_finite(t, i).empty())
      out[i] = PoseFault::not_finite;
    else if (!is_possible(t, i))
      out[i] = PoseFault::impossible;
    else
      good.push_back(i);
  }
  // The records that are left are held against one another, by time first: what follows divides by it.
  const auto judge = [&](PoseFault fault, const auto& contradict) {
    const std::vector<size_t> bad = contradicted(good.size(), [&](size_t i, size_t j) { return contradict(good[i], good[j]); });
    for (const size_t k : bad) out[good[k]] = fault;
    std::erase_if(good, [&](size_t i) { return out[i] != PoseFault::none; });
  };
  const auto apart = [&](size_t i, size_t j) { return std::abs(t.time[i] - t.time[j]); };
  judge(PoseFault::time, [&](size_t i, size_t j) { return apart(i, j) > max_apart; });
  std::vector<Eigen::Vector3d> ecef(t.size());
  for (const size_t i : good) ecef[i] = core::ecef_of({t.latitude[i], t.longitude[i], t.height[i]});
  judge(PoseFault::place, [&](size_t i, size_t j) { return (ecef[i] - ecef[j]).norm() > near + fastest * apart(i, j); });
  judge(PoseFault::attitude, [&](size_t i, size_t j) {
    const double most = turn + turn_rate * apart(i, j);
    if (std::abs(t.pitch[i] - t.pitch[j]) > most) return true;
    if (std::max(std::abs(t.pitch[i]), std::abs(t.pitch[j])) > steep_pitch) return false;
    return std::abs(core::wrap_pi(t.roll[i] - t.roll[j])) > most || std::abs(core::wrap_pi(t.heading[i] - t.heading[j])) > most;
  });
  return out;
}

void leave_out(core::TrajectoryData& t, const std::vector<std::uint8_t>& dropped) {
  core::for_each_trajectory_column([&](auto member, const char*) { leave_out(t.*member, dropped); });
}

std::vector<std::uint8_t> leave_out_faults(core::TrajectoryData& t, const std::string& name, core::Tally& tally) {
  const std::vector<PoseFault> faults = pose_faults(t);
  std::array<std::uint64_t, 6> n{};
  for (const PoseFault f : faults) ++n[static_cast<size_t>(f)];
  const auto of = [&](PoseFault f) { return n[static_cast<size_t>(f)]; };
  if (of(PoseFault::none) == t.size()) return {};
  const auto where = [&](size_t i) { return name + ": record " + std::to_string(i); };
  for (size_t i = 0; i < t.size(); ++i) {
    if (faults[i] == PoseFault::not_finite && !are_few(of(faults[i]), t.size()))
      throw core::Error(value_text(t, i), where(i), "the file is damaged: export the trajectory again");
    if (faults[i] == PoseFault::impossible && !are_few(of(faults[i]), t.size()))
      throw core::Error("the pose is impossible: " + value_text(t, i), where(i), "check the columns, the angle unit and crs");
  }
  std::vector<std::uint8_t> dropped(t.size(), 0);
  for (size_t i = 0; i < t.size(); ++i) {
    if (faults[i] == PoseFault::none || !are_few(of(faults[i]), t.size())) continue;
    dropped[i] = 1;
    if (std::isnan(t.time[i])) continue;  // counted where it was read
    if (faults[i] == PoseFault::time)
      tally.count(impossible_times, where(i) + ": " + core::utc_text(t.time[i]));
    else if (faults[i] == PoseFault::not_finite || faults[i] == PoseFault::impossible)
      tally.count("trajectory records with a value that is missing or impossible, left out", where(i) + ": " + value_text(t, i));
    else
      tally.count(faults[i] == PoseFault::place ? "trajectory records far from those around them, left out"
                                                : "trajectory records with an attitude far from those around them, left out",
                  where(i) + ": " + value_text(t, i));
  }
  leave_out(t, dropped);
  return dropped;
}

}  // namespace swath::io
