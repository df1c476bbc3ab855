// SPDX-License-Identifier: GPL-3.0-or-later
// Brandalize, tables 06 (planimetry) and 09 (heights). Table 09 prints for class A the figures of class B, 3/5 and 2/5 of the interval; the
// decree has 1/2 and 1/3. Both are here by their name.
#include "quality/map_class.h"

#include <algorithm>

#include "core/error.h"

namespace swath::quality {
namespace {

constexpr double rounding = 1.0 + 1e-9;  // a limit that is met exactly is met

bool is_within(double ep, std::optional<double> q90, double ep_limit, double pec_limit) {
  return ep <= ep_limit * rounding && (!q90 || *q90 <= pec_limit * rounding);
}

}  // namespace

std::vector<MapClass> map_classes(MapRule rule) {
  switch (rule) {
    case MapRule::decree:
      return {{"A", 0.5, 0.3, 1.0 / 2, 1.0 / 3}, {"B", 0.8, 0.5, 3.0 / 5, 2.0 / 5}, {"C", 1.0, 0.6, 3.0 / 4, 1.0 / 2}};
    case MapRule::paper:
      return {{"A", 0.5, 0.3, 3.0 / 5, 2.0 / 5}, {"B", 0.8, 0.5, 3.0 / 5, 2.0 / 5}, {"C", 1.0, 0.6, 3.0 / 4, 1.0 / 2}};
    case MapRule::pcd:
      return {{"A", 0.28, 0.17, 0.27, 1.0 / 6},
              {"B", 0.5, 0.3, 1.0 / 2, 1.0 / 3},
              {"C", 0.8, 0.5, 3.0 / 5, 2.0 / 5},
              {"D", 1.0, 0.6, 3.0 / 4, 1.0 / 2}};
  }
  return {};
}

MapLimits ground_limits(const MapClass& c, double scale, double interval) {
  const double metres = 1e-3 * scale;  // of one millimetre on the map
  return {c.plan_pec * metres, c.plan_ep * metres, c.height_pec * interval, c.height_ep * interval};
}

std::string plan_class(MapRule rule, double scale, double ep, std::optional<double> q90) {
  for (const MapClass& c : map_classes(rule))
    if (const MapLimits l = ground_limits(c, scale, 1.0); is_within(ep, q90, l.plan_ep, l.plan_pec)) return c.name;
  return {};
}

std::string height_class(MapRule rule, double interval, double ep, std::optional<double> q90) {
  for (const MapClass& c : map_classes(rule))
    if (const MapLimits l = ground_limits(c, 1.0, interval); is_within(ep, q90, l.height_ep, l.height_pec)) return c.name;
  return {};
}

std::string both_classes(const std::string& plan, const std::string& height) {
  return plan.empty() || height.empty() ? std::string() : std::max(plan, height);
}

double closest_interval(MapRule rule, const std::string& name, double ep, std::optional<double> q90) {
  for (const MapClass& c : map_classes(rule))
    if (c.name == name) return std::max(ep / c.height_ep, q90.value_or(0.0) / c.height_pec);
  throw core::Error("no class '" + name + "' by this rule", "", "classes are A, B, C, and D of pcd");
}

}  // namespace swath::quality
