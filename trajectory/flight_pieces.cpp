// SPDX-License-Identifier: GPL-3.0-or-later
// Turbulence shakes the course over one step by a degree and more; over five seconds it does so by a tenth of that, and a turn at a bank of
// 5 degrees and 60 m/s still changes it by 4 degrees.
#include "trajectory/flight_pieces.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/geo/frames.h"
#include "core/statistics.h"

namespace swath::trajectory {

namespace {

constexpr double course_base = 5.0;         // s on each side
constexpr double standing_speed = 0.5;      // m/s
constexpr double shortest_straight = 10.0;  // s: less between two turns belongs to them
constexpr double level_seconds = 60.0;      // about the length of a piece of one level
constexpr size_t level_fixes = 60, fewest_level_fixes = 20;

// The mean velocity between fix i and the one about `course_base` away, in the direction of `step`; within [first, end).
Eigen::Vector2d chord(const PointFixes& fixes, size_t i, int step, size_t first, size_t end) {
  size_t j = i;
  while ((step > 0 ? j + 1 < end : j > first) && std::abs(fixes.time[j] - fixes.time[i]) < course_base) j += static_cast<size_t>(step);
  if (j == i) return Eigen::Vector2d::Zero();
  return (fixes.position[j] - fixes.position[i]).head<2>() / (fixes.time[j] - fixes.time[i]);
}

double course_of(const Eigen::Vector2d& velocity) { return std::atan2(velocity.x(), velocity.y()); }

PieceKind kind_at(const PointFixes& fixes, size_t i, size_t first, size_t end, double turn_rate) {
  const Eigen::Vector2d before = chord(fixes, i, -1, first, end), after = chord(fixes, i, 1, first, end);
  if (std::max(before.norm(), after.norm()) < standing_speed) return PieceKind::standing;
  if (std::min(before.norm(), after.norm()) < standing_speed) return PieceKind::straight;
  const double rate = std::abs(core::wrap_pi(course_of(after) - course_of(before))) / course_base;
  return rate > turn_rate ? PieceKind::turn : PieceKind::straight;
}

void finish(const PointFixes& fixes, FlightPiece& p) {
  const Eigen::Vector2d way = (fixes.position[p.end - 1] - fixes.position[p.first]).head<2>();
  if (p.kind == PieceKind::straight) p.course = std::fmod(course_of(way) + 2.0 * core::pi, 2.0 * core::pi);
}

}  // namespace

std::string FlightPiece::name(int number) const {
  char text[60];
  switch (kind) {
    case PieceKind::line:
      return "line " + std::to_string(line);
    case PieceKind::turn:
      return "turns";
    case PieceKind::standing:
      return "standing";
    case PieceKind::straight:
      break;
  }
  std::snprintf(text, sizeof text, "straight %d, %.0f deg", number, course / core::degree);
  return text;
}

std::vector<FlightPiece> pieces_by_course(const PointFixes& fixes, double turn_rate, double longest_step) {
  std::vector<FlightPiece> out;
  size_t first = 0;
  while (first < fixes.size()) {
    size_t end = first + 1;
    while (end < fixes.size() && fixes.time[end] - fixes.time[end - 1] <= longest_step) ++end;
    std::vector<FlightPiece> part;
    for (size_t i = first; i < end; ++i) {
      const PieceKind kind = kind_at(fixes, i, first, end, turn_rate);
      if (part.empty() || part.back().kind != kind) part.push_back({kind, i, i});
      part.back().end = i + 1;
    }
    for (FlightPiece& p : part)
      if (p.kind == PieceKind::straight && part.size() > 1 && fixes.time[p.end - 1] - fixes.time[p.first] < shortest_straight)
        p.kind = PieceKind::turn;
    for (const FlightPiece& p : part) {
      if (!out.empty() && out.back().end == p.first && p.first > first && out.back().kind == p.kind)
        out.back().end = p.end;
      else
        out.push_back(p);
    }
    first = end;
  }
  for (FlightPiece& p : out) finish(fixes, p);
  return out;
}

std::vector<FlightPiece> pieces_by_line(const PointFixes& fixes, const std::vector<LineSpan>& lines) {
  std::vector<FlightPiece> out;
  const auto line_at = [&](double t) {
    for (const LineSpan& l : lines)
      if (t >= l.start && t <= l.end) return &l;
    return static_cast<const LineSpan*>(nullptr);
  };
  const LineSpan* before = nullptr;
  for (size_t i = 0; i < fixes.size(); ++i) {
    const LineSpan* here = line_at(fixes.time[i]);
    if (i == 0 || here != before) out.push_back({here ? PieceKind::line : PieceKind::turn, i, i, here ? here->line : 0});
    out.back().end = i + 1;
    before = here;
  }
  return out;
}

std::vector<size_t> level_pieces(const PointFixes& fixes, const std::vector<FlightPiece>& pieces) {
  const double step = core::median_step(fixes.time);
  const size_t longest = std::max(level_fixes, static_cast<size_t>(level_seconds / step));
  std::vector<size_t> out{0};
  for (const FlightPiece& p : pieces) {
    const size_t parts = (p.size() + longest - 1) / longest;
    for (size_t k = 0; k < parts; ++k) {
      const size_t at = p.first + k * p.size() / parts;
      if (at - out.back() >= fewest_level_fixes) out.push_back(at);
    }
  }
  if (out.size() > 1 && fixes.size() - out.back() < fewest_level_fixes) out.pop_back();
  return out;
}

}  // namespace swath::trajectory
