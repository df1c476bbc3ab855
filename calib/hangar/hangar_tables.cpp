// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/hangar/hangar_tables.h"

#include <array>
#include <cstdio>

#include "calib/hangar/lever_arm.h"
#include "core/config/option.h"
#include "core/config/units.h"
#include "core/geo/frames.h"

namespace swath::calib {
namespace {

constexpr std::array<double, 6> tilts{0.0, 1.0, 2.0, 3.0, 5.0, 10.0};  // deg

std::string six(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  char text[120];
  std::snprintf(text, sizeof text, "%10.3f %10.3f %10.3f %8.3f %8.3f %8.3f\n", a.x(), a.y(), a.z(), b.x(), b.y(), b.z());
  return text;
}

std::string named(const std::string& name) {
  char text[60];
  std::snprintf(text, sizeof text, "%-32.32s", name.c_str());
  return text;
}

std::string_view role_name(io::HangarRole role) { return core::Choices<io::HangarRole>::names[static_cast<size_t>(role)]; }

constexpr const char* xyz = "               X (m)      Y (m)      Z (m)    sigma of X, Y, Z (m)\n";
constexpr const char* body = "             forward      right       down    sigma of each (m)\n";

}  // namespace

std::string tables_of(const HangarResult& result, double tilt_sigma) {
  std::string out = "Stations\n" + named("") + xyz;
  for (const StationResult& s : result.stations) out += named(s.name) + six(s.position, s.covariance.diagonal().cwiseMax(0).cwiseSqrt());
  out += "\nPoints\n" + named("") + xyz;
  for (const PointResult& p : result.points) out += named(p.name) + six(p.position, p.covariance.diagonal().cwiseMax(0).cwiseSqrt());
  out += "\nLever arms (m)\n" + named("") + body;
  const auto way = [](const LeverArm& l) { return std::string(role_name(l.from)) + " to " + std::string(role_name(l.to)); };
  for (const LeverArm& l : result.lever_arms) out += named(way(l)) + six(l.value, l.covariance.diagonal().cwiseMax(0).cwiseSqrt());
  char head[120];
  std::snprintf(head, sizeof head, "\nUnder tilt, in level axes, tilt known to %.3f deg: shift and sigma (m)\n", tilt_sigma / core::degree);
  out += head + named("") + body;
  for (const LeverArm& l : result.lever_arms)
    for (const bool is_roll : {true, false})
      for (const double degrees : tilts) {
        if (degrees == 0.0 && !is_roll) continue;
        const double angle = degrees * core::degree;
        const TiltedArm t = tilted(l.value, l.covariance, {is_roll ? angle : 0.0, is_roll ? 0.0 : angle, 0.0}, tilt_sigma);
        std::snprintf(head, sizeof head, "%s, %s %.0f deg", way(l).c_str(), is_roll ? "roll" : "pitch", degrees);
        out += named(head) + six(t.shift, t.sigma);
      }
  return out;
}

}  // namespace swath::calib
