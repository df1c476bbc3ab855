// SPDX-License-Identifier: GPL-3.0-or-later
// Dubins' six words in the unit frame of the first place: d the distance, a and b the courses from the line between the places, all turned
// counter-clockwise (Shkel and Lumelsky 2001, table of segments).
#include "planning/turn.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace swath::planning {
namespace {

constexpr double g0 = 9.80665, two_pi = 2.0 * std::numbers::pi;

double positive(double angle) {
  constexpr double rounding = 1e-9;  // a turn by nothing must not become a whole one
  const double a = std::fmod(angle, two_pi) + (angle < 0.0 ? two_pi : 0.0);
  return a > two_pi - rounding ? 0.0 : a;
}

}  // namespace

double turn_radius(double speed, double bank) { return speed * speed / (g0 * std::tan(bank)); }

double turn_length(const Eigen::Vector2d& from, double course, const Eigen::Vector2d& to, double course_there, double radius) {
  const Eigen::Vector2d way = (to - from) / radius;
  const double d = way.norm(), bearing = std::atan2(way.y(), way.x());
  // Counter-clockwise from the way between the places; courses are clockwise from north.
  const double a = positive(std::numbers::pi / 2 - course - bearing), b = positive(std::numbers::pi / 2 - course_there - bearing);
  const double sa = std::sin(a), ca = std::cos(a), sb = std::sin(b), cb = std::cos(b), cab = std::cos(a - b);
  double best = std::numeric_limits<double>::infinity();
  const auto take = [&best](double first, double middle, double last) { best = std::min(best, positive(first) + middle + positive(last)); };

  // Without a straight part between them two turns to one side are one, and the course between them is any.
  constexpr double nothing = 1e-12;
  if (const double p2 = 2 + d * d - 2 * cab + 2 * d * (sa - sb); p2 > nothing) {  // LSL
    const double t = std::atan2(cb - ca, d + sa - sb);
    take(t - a, std::sqrt(p2), b - t);
  } else {
    take(b - a, 0.0, 0.0);
  }
  if (const double p2 = 2 + d * d - 2 * cab + 2 * d * (sb - sa); p2 > nothing) {  // RSR
    const double t = std::atan2(ca - cb, d - sa + sb);
    take(a - t, std::sqrt(p2), t - b);
  } else {
    take(a - b, 0.0, 0.0);
  }
  if (const double p2 = -2 + d * d + 2 * cab + 2 * d * (sa + sb); p2 >= 0) {  // LSR
    const double p = std::sqrt(p2), t = std::atan2(-ca - cb, d + sa + sb) - std::atan2(-2.0, p);
    take(t - a, p, t - b);
  }
  if (const double p2 = -2 + d * d + 2 * cab - 2 * d * (sa + sb); p2 >= 0) {  // RSL
    const double p = std::sqrt(p2), t = std::atan2(ca + cb, d - sa - sb) - std::atan2(2.0, p);
    take(a - t, p, b - t);
  }
  if (const double c = (6 - d * d + 2 * cab + 2 * d * (sa - sb)) / 8; std::abs(c) <= 1) {  // RLR
    const double p = two_pi - std::acos(c), t = a - std::atan2(ca - cb, d - sa + sb) + p / 2;
    take(t, p, a - b - t + p);
  }
  if (const double c = (6 - d * d + 2 * cab + 2 * d * (sb - sa)) / 8; std::abs(c) <= 1) {  // LRL
    const double p = two_pi - std::acos(c), t = -a + std::atan2(-ca + cb, d + sa - sb) + p / 2;
    take(t, p, b - a - t + p);
  }
  return best * radius;
}

}  // namespace swath::planning
