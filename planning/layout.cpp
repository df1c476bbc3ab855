// SPDX-License-Identifier: GPL-3.0-or-later
// The first line is put as far into the area as its swath still holds the area's edge, each next one as far from the last as the overlap
// allows, until the far edge is held; then the overlap is raised as far as the same number of lines allows, so that all share what is left
// over. A swath ends where the outermost beam first meets the ground.
#include "planning/layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "core/ring.h"

namespace swath::planning {
namespace {

using Eigen::Vector2d;

constexpr size_t most_spread = 300;  // lines; of more what is left over is little
constexpr int most_stations = 60, most_lines = 2000, edge_steps = 48, halvings = 22;
constexpr double least_advance = 0.005;  // from line to line, share of the widest swath
constexpr double degree = std::numbers::pi / 180.0;

/// Coordinates along the lines and across them, to starboard of the first.
struct Frame {
  Vector2d along, across;
  explicit Frame(double direction) : along(std::sin(direction), std::cos(direction)), across(std::cos(direction), -std::sin(direction)) {}
  Vector2d of(const Vector2d& map) const { return {along.dot(map), across.dot(map)}; }
  Vector2d map(double s, double t) const { return s * along + t * across; }
};

struct Span {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void take(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  bool any() const { return high >= low; }
  double width() const { return high - low; }
};

Span across_span(const std::vector<Ring>& rings, const Frame& frame) {
  Span out;
  for (const Ring& r : rings)
    for (const Vector2d& p : r) out.take(frame.across.dot(p));
  return out;
}

/// How far along the part of the area reaches that lies between two lines across coordinate low and high.
Span along_span(const std::vector<Ring>& rings, const Frame& frame, double low, double high) {
  Span out;
  for (const Ring& r : rings)
    for (size_t k = 0; k < r.size(); ++k) {
      const Vector2d a = frame.of(r[k]), b = frame.of(r[(k + 1) % r.size()]);
      if (a.y() >= low && a.y() <= high) out.take(a.x());
      for (const double t : {low, high})
        if ((a.y() - t) * (b.y() - t) < 0.0) out.take(a.x() + (t - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
    }
  return out;
}

double narrowest_direction(const std::vector<Ring>& rings) {
  double best = 0.0, least = std::numeric_limits<double>::infinity();
  for (int tenth = 0; tenth < 1800; ++tenth) {
    const double direction = 0.1 * tenth * degree, width = across_span(rings, Frame(direction)).width();
    if (width < least - 1e-6) {
      least = width;
      best = direction;
    }
  }
  return best;
}

class Planner {
 public:
  Planner(const LayoutTask& task, const core::HeightField& ground, double direction)
      : task_(task), ground_(ground), frame_(direction), tangent_(std::tan(task.half_angle)) {
    edges_ = across_span(task.area, frame_);
    reference_ = level_between(edges_.low, edges_.high);
  }

  Layout plan() {
    std::vector<double> places = places_with(task_.overlap);
    if (!task_.spacing && places.size() > 1 && places.size() <= most_spread) {
      double low = task_.overlap, high = 0.98;
      for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (low + high);
        std::vector<double> tried = places_with(middle, places.size());
        if (tried.size() <= places.size()) {
          low = middle;
          places = std::move(tried);
        } else {
          high = middle;
        }
      }
    }
    return lines_at(places);
  }

 private:
  /// Height of the flight, m, where the ground between two coordinates across is its ground.
  double level_between(double low, double high) const {
    const Span reach = along_span(task_.area, frame_, low, high);
    if (!reach.any()) return reference_;
    constexpr int steps = 80;
    double sum = 0.0, lowest = std::numeric_limits<double>::infinity();
    int n = 0;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; j <= steps / 4; ++j) {
        const Vector2d p = frame_.map(reach.low + reach.width() * i / steps, low + (high - low) * 4 * j / steps);
        if (!inside(task_.area, p)) continue;
        const double h = ground_.height(p.x(), p.y());
        sum += h;
        lowest = std::min(lowest, h);
        ++n;
      }
    if (n == 0) {
      const Vector2d p = frame_.map(0.5 * (reach.low + reach.high), 0.5 * (low + high));
      sum = lowest = ground_.height(p.x(), p.y());
      n = 1;
    }
    return (task_.above_lowest ? lowest : sum / n) + task_.height;
  }

  double level_at(double t) const {
    if (!task_.terrain_following) return reference_;
    const double reach = task_.height * tangent_;
    const double level = level_between(std::max(t - reach, edges_.low), std::min(t + reach, edges_.high));
    return task_.level_step * std::round(level / task_.level_step);
  }

  /// Distance from the line to the swath's edge on one side (-1 to port, 1 to starboard), m.
  double edge(double s, double t, double level, double side) const {
    const double farthest = (level - ground_.lowest()) * tangent_, step = farthest / edge_steps;
    const auto beyond = [&](double y) {  // the beam that meets the ground there is outside of the field of view
      const Vector2d p = frame_.map(s, t + side * y);
      return y - (level - ground_.height(p.x(), p.y())) * tangent_ > 0.0;
    };
    double low = 0.0, high = step;
    for (; high < farthest && !beyond(high); high += step) low = high;
    for (int i = 0; i < 12; ++i) (beyond(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
    return 0.5 * (low + high);
  }

  std::vector<double> stations(double low, double high) const {
    Span reach = along_span(task_.area, frame_, std::max(low, edges_.low), std::min(high, edges_.high));
    if (!reach.any()) reach = along_span(task_.area, frame_, edges_.low, edges_.high);
    const int n = std::clamp(static_cast<int>(reach.width() / (0.1 * task_.height)), 4, most_stations);
    std::vector<double> out;
    for (int i = 0; i <= n; ++i) out.push_back(reach.low - task_.margin + (reach.width() + 2 * task_.margin) * i / n);
    return out;
  }

  /// Least overlap of a line at `next` with one at `t`, and the station where.
  std::pair<double, double> overlap(double t, double next) const {
    const double level = level_at(t), next_level = level_at(next);
    std::pair<double, double> least{std::numeric_limits<double>::infinity(), 0.0};
    for (const double s : stations(t, next)) {
      const double starboard = edge(s, t, level, 1), port = edge(s, next, next_level, -1);
      const double width = std::max(1e-9, 0.5 * (starboard + port + edge(s, t, level, -1) + edge(s, next, next_level, 1)));
      least = std::min(least, {(t + starboard - next + port) / width, s});
    }
    return least;
  }

  /// By how much the swath of a line at t holds the area's edge on one side, m.
  double held(double t, double side) const {
    const double level = level_at(t), limit = (side < 0 ? edges_.low : edges_.high) + side * task_.margin;
    const double reach = task_.height * tangent_;
    double least = std::numeric_limits<double>::infinity();
    for (const double s : side < 0 ? stations(edges_.low, edges_.low + reach) : stations(edges_.high - reach, edges_.high))
      least = std::min(least, edge(s, t, level, side) - side * (limit - t));
    return least;
  }

  template <class F>
  static double last_that_holds(double good, double bad, const F& holds) {
    for (int i = 0; i < halvings; ++i) (holds(0.5 * (good + bad)) ? good : bad) = 0.5 * (good + bad);
    return good;
  }

  /// Coordinates of the lines across; one more than `at_most` where that does not do.
  std::vector<double> places_with(double overlap_wanted, size_t at_most = most_lines) const {
    const double widest = 2 * (reference_ - ground_.lowest() + task_.height) * tangent_;
    if (task_.spacing) return evenly_spaced();
    std::vector<double> out;
    const double start = edges_.low - task_.margin;
    out.push_back(last_that_holds(start, start + widest, [&](double t) { return held(t, -1) >= 0.0; }));
    while (held(out.back(), 1) < 0.0 && out.size() <= at_most) {
      const double t = out.back();
      const double next = last_that_holds(t, t + widest, [&](double n) { return overlap(t, n).first >= overlap_wanted; });
      if (next - t < least_advance * widest) throw_too_many();
      out.push_back(next);
    }
    if (out.size() > most_lines) throw_too_many();
    return out;
  }

  std::vector<double> evenly_spaced() const {
    const double wanted = edges_.width() + 2 * task_.margin, swath = 2 * task_.height * tangent_;
    const double n = std::max(1.0, std::ceil((wanted - swath) / *task_.spacing - 1e-9) + 1.0);
    if (n > most_lines) throw_too_many();
    std::vector<double> out;
    for (int i = 0; i < static_cast<int>(n); ++i) out.push_back(0.5 * (edges_.low + edges_.high) + (i - 0.5 * (n - 1)) * *task_.spacing);
    return out;
  }

  [[noreturn]] static void throw_too_many() {
    throw core::usage_error("no lines hold the area with that overlap: more than 2000 are needed, or the ground is too near", "flight",
                            "fly higher, ask for less overlap, or set flight.terrain_following = true");
  }

  Layout lines_at(const std::vector<double>& places) const {
    Layout out;
    int number = 0;
    for (const double t : places) {
      const double level = level_at(t), reach = (level - ground_.lowest()) * tangent_;
      Span span = along_span(task_.area, frame_, std::max(edges_.low, t - reach), std::min(edges_.high, t + reach));
      if (!span.any()) span = along_span(task_.area, frame_, edges_.low, edges_.high);
      const Vector2d first = frame_.map(span.low - task_.margin, t), last = frame_.map(span.high + task_.margin, t);
      const bool back = number % 2 == 1;
      out.lines.push_back({"line " + std::to_string(++number), back ? last : first, back ? first : last, level});
    }
    for (size_t k = 1; k < places.size(); ++k) {
      const auto [share, s] = overlap(places[k - 1], places[k]);
      if (out.least_overlap && *out.least_overlap <= share) continue;
      out.least_overlap = share;
      out.least_overlap_at = frame_.map(s, 0.5 * (places[k - 1] + places[k]));
    }
    add_cross_lines(out);
    return out;
  }

  void add_cross_lines(Layout& out) const {
    const Span whole = along_span(task_.area, frame_, edges_.low, edges_.high);
    Frame turned = frame_;
    std::swap(turned.along, turned.across);
    for (int i = 0; i < task_.cross_lines; ++i) {
      const double s = whole.low + whole.width() * (i + 0.5) / task_.cross_lines, reach = task_.height * tangent_;
      Span span = along_span(task_.area, turned, std::max(whole.low, s - reach), std::min(whole.high, s + reach));
      if (!span.any()) span = edges_;
      const Vector2d first = frame_.map(s, span.low - task_.margin), last = frame_.map(s, span.high + task_.margin);
      FlightLine line{"cross line " + std::to_string(i + 1), i % 2 ? last : first, i % 2 ? first : last, reference_, true};
      if (task_.terrain_following) line.level = task_.level_step * std::round(cross_level(s, span) / task_.level_step);
      out.lines.push_back(line);
    }
  }

  double cross_level(double s, const Span& span) const {
    constexpr int steps = 200;
    double sum = 0.0, lowest = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= steps; ++i) {
      const Vector2d p = frame_.map(s, span.low + span.width() * i / steps);
      sum += ground_.height(p.x(), p.y());
      lowest = std::min(lowest, ground_.height(p.x(), p.y()));
    }
    return (task_.above_lowest ? lowest : sum / (steps + 1)) + task_.height;
  }

  const LayoutTask& task_;
  const core::HeightField& ground_;
  Frame frame_;
  double tangent_, reference_ = 0.0;
  Span edges_;
};

}  // namespace

bool inside(const std::vector<Ring>& rings, const Vector2d& place) {
  bool in = false;
  for (const Ring& r : rings)
    for (size_t k = 0; k < r.size(); ++k) in = in != core::crosses_eastward(r[k], r[(k + 1) % r.size()], place.x(), place.y());
  return in;
}

double FlightLine::course() const {
  const double course = std::atan2(along().x(), along().y());
  return course < 0.0 ? course + 2.0 * std::numbers::pi : course;
}

Extent extent_of(const std::vector<Ring>& area, const std::optional<double>& asked) {
  const double direction = asked.value_or(narrowest_direction(area));
  const Frame frame(direction);
  const Span across = across_span(area, frame), along = along_span(area, frame, across.low, across.high);
  return {frame.map(0.5 * (along.low + along.high), 0.5 * (across.low + across.high)), direction, along.width(), across.width()};
}

Layout lay_out(const LayoutTask& task, const core::HeightField& ground) {
  const double direction = task.direction.value_or(narrowest_direction(task.area));
  Layout out = Planner(task, ground, direction).plan();
  out.direction = direction;
  return out;
}

}  // namespace swath::planning
