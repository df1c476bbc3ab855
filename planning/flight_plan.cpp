// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/flight_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/error.h"
#include "core/ring.h"
#include "core/statistics.h"
#include "planning/calibration_flight.h"
#include "planning/eye_safety.h"
#include "planning/profiling.h"
#include "planning/turn.h"

namespace swath::planning {
namespace {

using Eigen::Vector2d;

constexpr double farthest_base = 50e3, near_base = 10e3;  // Brandalize: bases within 10 to 50 km
constexpr double most_cells = 16e6, most_unknown = 0.01;
constexpr double ground_steps = 200;

std::string text(const char* format, double a, double b = 0.0, double c = 0.0) {
  char out[240];
  std::snprintf(out, sizeof out, format, a, b, c);
  return out;
}

/// The sensor with what must be given.
struct Sensor {
  double prf, frequency, half_angle, speed;
  explicit Sensor(const PlanOptions& o)
      : prf(o.sensor.prf->value),
        frequency(o.sensor.frequency->value),
        half_angle(o.sensor.half_angle->value),
        speed(o.flight.speed->value) {}
};

double area_of(const std::vector<Ring>& rings) {
  double sum = 0.0;
  for (size_t k = 0; k < rings.size(); ++k) {
    // An island in an area counts against it.
    const bool is_island = inside(
        [&] {
          std::vector<Ring> others = rings;
          others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
          return others;
        }(),
        rings[k].front());
    sum += (is_island ? -1.0 : 1.0) * std::abs(core::signed_area(rings[k]));
  }
  return sum;
}

/// What lies below the flight: places of the area, evenly spread.
struct Overview {
  double mean = 0.0, lowest = 1e9, highest = -1e9, unknown_share = 0.0;
  Vector2d highest_at = Vector2d::Zero(), unknown_at = Vector2d::Zero();
};

Overview look_over(const std::vector<Ring>& area, const core::HeightField& ground) {
  Vector2d low = area.front().front(), high = low;
  for (const Ring& r : area)
    for (const Vector2d& p : r) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  constexpr int steps = 200;
  Overview out;
  int all = 0, unknown = 0;
  for (int j = 0; j < steps; ++j)
    for (int i = 0; i < steps; ++i) {
      const Vector2d p = low + Vector2d((i + 0.5) / steps, (j + 0.5) / steps).cwiseProduct(high - low);
      if (!inside(area, p)) continue;
      ++all;
      const double height = ground.height(p.x(), p.y());
      out.mean += height;
      out.lowest = std::min(out.lowest, height);
      if (height > out.highest) {
        out.highest = height;
        out.highest_at = p;
      }
      if (!ground.knows(p.x(), p.y()) && unknown++ == 0) out.unknown_at = p;
    }
  if (all == 0)
    throw core::usage_error("the area is too narrow to be flown: no place lies within it", "area", "are its corners in their order?");
  out.mean /= all;
  out.unknown_share = static_cast<double>(unknown) / all;
  return out;
}

/// `height`: of the flight above its ground.
void check_ground(const PlanOptions& o, double height, const Overview& s) {
  if (s.unknown_share > most_unknown)
    throw core::usage_error(text("the terrain model has no height on %.1f %% of the area, first at %.0f east, %.0f north",
                                 100 * s.unknown_share, s.unknown_at.x(), s.unknown_at.y()),
                            "dem", "take a model that holds the whole area, and fill its voids");
  const double above = (o.flight.density ? s.lowest : s.mean) + height - s.highest;
  if (above < o.flight.clearance.value && !o.flight.terrain_following)
    throw core::usage_error(text("the ground at %.0f east, %.0f north rises to", s.highest_at.x(), s.highest_at.y()) +
                                text(" %.0f m below the flight, the least is %.0f m", above, o.flight.clearance.value),
                            "flight.clearance", "fly higher, or set flight.terrain_following = true");
}

/// m above the ground: as asked for, or as the density wants it.
double height_of(const PlanOptions& o, const Sensor& s) {
  if (o.flight.height) return o.flight.height->value;
  const double height = height_of_swath(s.prf / (s.speed * *o.flight.density), s.half_angle);
  if (height < o.flight.clearance.value)
    throw core::usage_error(text("%g pulses per m2 of one swath want a flying height of %.0f m, below the least of %.0f m",
                                 *o.flight.density, height, o.flight.clearance.value),
                            "flight.density",
                            "fly slower, take a higher pulse rate or a narrower field of view, or let more lines overlap");
  return height;
}

Layout lines_of(const PlanOptions& o, const Sensor& s, double height, const std::vector<Ring>& area, const core::HeightField& ground) {
  LayoutTask task;
  task.area = area;
  task.half_angle = s.half_angle;
  task.height = height;
  task.above_lowest = o.flight.density.has_value();
  task.terrain_following = o.flight.terrain_following;
  task.level_step = o.flight.level_step.value;
  task.overlap = o.flight.overlap;
  if (o.flight.spacing) task.spacing = o.flight.spacing->value;
  if (o.flight.direction) task.direction = o.flight.direction->value;
  task.cross_lines = o.flight.cross_lines;
  task.margin = o.flight.margin.value;
  const Layout layout = lay_out(task, ground);
  if (layout.least_overlap && *layout.least_overlap < 0.0)
    throw core::usage_error(text("neighbouring lines leave a gap of %.0f %% of the swath, at %.0f east, %.0f north",
                                 -100 * *layout.least_overlap, layout.least_overlap_at.x(), layout.least_overlap_at.y()),
                            "flight.spacing", "bring the lines closer together, fly higher, or give an overlap in place of the spacing");
  return layout;
}

/// Over the middle of the area, along its longer side or the direction that is asked for.
Layout calibration_of(const PlanOptions& o, const Sensor& s, const std::vector<Ring>& area, const core::HeightField& ground) {
  const Extent extent = extent_of(area, o.flight.direction ? std::optional(o.flight.direction->value) : std::nullopt);
  const Vector2d along(std::sin(extent.direction), std::cos(extent.direction)), across(along.y(), -along.x());
  Layout out;
  out.direction = extent.direction;
  CalibrationFlight task;
  task.height = o.flight.height->value;
  task.second_height = o.flight.second_height ? o.flight.second_height->value : 11.0 / 7.0 * task.height;
  task.half_angle = s.half_angle;
  task.length = extent.length + 0.7 * task.height;
  task.target_half_width = 0.1 * swath_width(task.height, task.half_angle);
  task.profile_lines = o.sensor.pattern != ScanPattern::polygon;  // a polygon cannot stand still
  const auto place = [&](const Vector2d& p) -> Vector2d { return extent.middle + p.x() * along + p.y() * across; };
  const double level = ground.height(extent.middle.x(), extent.middle.y()) + task.height;
  for (const CalibrationLine& l : calibration_lines(task))
    out.lines.push_back({l.name, place(l.from), place(l.to), level + l.level, false, l.scans});
  return out;
}

LineFound look_at(const FlightLine& line, const core::HeightField& ground) {
  LineFound out{line, 1e9, 0.0, -1e9, 0.0, 0.0, {}};
  for (int i = 0; i <= static_cast<int>(ground_steps); ++i) {
    const Vector2d p = line.from + (line.to - line.from) * i / ground_steps;
    const double h = line.level - ground.height(p.x(), p.y());
    out.lowest = std::min(out.lowest, h);
    out.highest = std::max(out.highest, h);
    out.mean += h / (ground_steps + 1);
  }
  return out;
}

void add_times(const PlanOptions& o, const Sensor& s, std::vector<LineFound>& lines) {
  const double lead = o.flight.lead.value * s.speed, radius = turn_radius(s.speed, o.flight.bank.value);
  for (size_t k = 0; k < lines.size(); ++k) {
    LineFound& l = lines[k];
    l.seconds = l.line.length() / s.speed;
    l.turn_seconds = 2 * o.flight.lead.value;
    if (k == 0) continue;
    const FlightLine& last = lines[k - 1].line;
    const double way =
        turn_length(last.to + lead * last.along(), last.course(), l.line.from - lead * l.line.along(), l.line.course(), radius);
    l.turn_seconds += std::max(way / s.speed, std::abs(l.line.level - last.level) / o.flight.climb_rate.value);
  }
}

void add_bases(const PlanOptions& o, FlightPlan& plan) {
  if (o.bases.empty()) return;
  double farthest = 0.0;
  std::string line;
  for (LineFound& l : plan.lines) {
    double distance = 0.0;
    for (const Vector2d& end : {l.line.from, l.line.to}) {
      double nearest = 1e12;
      for (const BaseOptions& b : o.bases) nearest = std::min(nearest, (Vector2d(b.east.value, b.north.value) - end).norm());
      distance = std::max(distance, nearest);
    }
    l.base_distance = distance;
    if (distance > farthest) {
      farthest = distance;
      line = l.line.name;
    }
  }
  if (farthest > farthest_base)
    plan.warnings.push_back(
        line + text(": %.0f km from the nearest base station; beyond 50 km fixed ambiguities are not to be expected", 1e-3 * farthest));
  else if (farthest > near_base)
    plan.warnings.push_back(line + text(": %.0f km from the nearest base station; up to 10 km is best", 1e-3 * farthest));
}

void check_heights(const PlanOptions& o, const FlightPlan& plan) {
  for (const LineFound& l : plan.lines)
    if (l.lowest < o.flight.clearance.value)
      throw core::usage_error(
          l.line.name + text(" comes within %.0f m of the ground, the least is %.0f m", l.lowest, o.flight.clearance.value),
          "flight.clearance", "fly higher, or set flight.terrain_following = true");
}

/// Eye safety and ranges.
void check_laser(const PlanOptions& o, const Sensor& s, const core::HeightField& ground, FlightPlan& plan) {
  double lowest = 1e9, longest = 0.0;
  for (const LineFound& l : plan.lines) {
    lowest = std::min(lowest, l.lowest);
    longest = std::max(longest, (l.line.level - ground.lowest()) / std::cos(s.half_angle));
  }
  plan.swath.pulses_in_air = time_of_flight(longest) * s.prf;
  if (plan.swath.pulses_in_air > 1.0 && !o.sensor.multiple_pulses)
    throw core::usage_error(
        text("up to %.1f pulses are in the air at a time: at %.0f pulses per s one echo comes back before the next pulse "
             "from ranges up to %.0f m alone",
             plan.swath.pulses_in_air, s.prf, 0.5 * speed_of_light / s.prf),
        "sensor.prf", "lower the pulse rate or the height; a sensor that tells pulses apart: sensor.multiple_pulses = true");
  if (o.sensor.max_range && longest > o.sensor.max_range->value)
    plan.warnings.push_back(
        text("the lowest ground lies up to %.0f m from the sensor, beyond its range of %.0f m", longest, o.sensor.max_range->value));
  if (!o.sensor.pulse_energy) return;
  const LaserPulses laser{o.sensor.pulse_energy->value, o.sensor.wavelength.value, o.sensor.divergence.value, s.prf,
                          angular_speed(o.sensor.pattern, s.half_angle, s.frequency)};
  const std::optional<EyeSafety> safe = eye_safety(laser);
  if (!safe) return;
  plan.eye_safety = EyeSafetyFound{safe->height, safe->with_binoculars, safe->exposure, safe->pulses, lowest};
  if (lowest < safe->height)
    throw core::usage_error(
        text("eyes on the ground are safe from %.0f m on, the flight comes down to %.0f m (IEC 60825-1:2014)", safe->height, lowest),
        "sensor.pulse_energy", "fly higher, or take less energy or a wider beam");
  if (lowest < safe->with_binoculars)
    plan.warnings.push_back(
        text("an eye behind binoculars is safe from %.0f m on, the flight comes down to %.0f m", safe->with_binoculars, lowest));
}

SwathFound swath_of(const PlanOptions& o, const Sensor& s, double height) {
  SwathFound w;
  w.height = height;
  w.footprint = footprint(o.sensor.divergence.value, height);
  w.width = swath_width(height, s.half_angle);
  const double lines = lines_per_second(o.sensor.pattern, s.frequency);
  w.across = spacing_across(0.5 * lines, w.width, s.prf);
  w.along = spacing_along(s.speed, 0.5 * lines);
  w.density = density(s.prf, s.speed, w.width);
  w.ground_spacing = penetrated_spacing(1.0 / std::sqrt(w.density), o.penetration);
  w.time_of_flight = time_of_flight(height);
  return w;
}

Spread spread_of(const std::vector<float>& values) {
  std::vector<double> v;
  for (const float x : values)
    if (std::isfinite(x)) v.push_back(static_cast<double>(x));
  if (v.empty()) return {};
  std::sort(v.begin(), v.end());
  const auto at = [&v](double share) { return v[static_cast<size_t>(share * static_cast<double>(v.size() - 1) + 0.5)]; };
  double sum = 0.0;
  for (const double x : v) sum += x;
  return {v.front(), at(0.05), at(0.5), sum / static_cast<double>(v.size()), at(0.95), v.back()};
}

double share_of(const std::vector<float>& values, double below) {
  size_t n = 0, all = 0;
  for (const float v : values)
    if (std::isfinite(v)) {
      ++all;
      if (static_cast<double>(v) < below) ++n;
    }
  return all > 0 ? static_cast<double>(n) / static_cast<double>(all) : 0.0;
}

/// A round number (1, 2 or 5 times a power of ten) of about 1/40 of a swath; smaller over a small area, larger over a huge one.
double usual_cell(double swath, double area) {
  const double wanted = std::clamp(swath / 40.0, std::sqrt(area) / 1000.0, std::max(std::sqrt(area) / 20.0, 1e-3));
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double k : {5.0, 2.0})
    if (wanted >= k * power) return k * power;
  return power;
}

void add_coverage(const PlanOptions& o, const Sensor& s, const std::vector<Ring>& area, const core::HeightField& ground, FlightPlan& plan) {
  const double cell = o.cell ? o.cell->value : usual_cell(plan.swath.width, plan.area);
  Vector2d low = area.front().front(), high = low;
  for (const Ring& r : area)
    for (const Vector2d& p : r) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  if ((high - low).prod() / (cell * cell) > most_cells)
    throw core::usage_error("the area has more than 16 million cells", "cell", "larger cells");
  std::vector<FlightLine> lines;
  for (const LineFound& l : plan.lines) lines.push_back(l.line);
  const Beam beam{o.sensor.pattern, s.prf, s.speed, s.half_angle, o.sensor.max_range ? o.sensor.max_range->value : 0.0};
  core::SensorSigma sensor = o.sigma;
  if (sensor.beam_divergence.value == 0.0) sensor.beam_divergence = o.sensor.divergence;
  plan.coverage = coverage_of(lines, area, ground, beam, sensor, o.trajectory_sigma, cell);
  plan.density = spread_of(plan.coverage.density);
  plan.seen = spread_of(plan.coverage.lines);
  plan.sigma_height = spread_of(plan.coverage.sigma_height);
  plan.sigma_horizontal = spread_of(plan.coverage.sigma_horizontal);
  constexpr double none = 1e-6;  // pulses per m2
  plan.unseen_share = share_of(plan.coverage.density, none);
  if (plan.unseen_share > 0.0 && o.flight.pattern == PlanPattern::block)
    plan.warnings.push_back(
        text("%.2f %% of the area is seen by no line: behind ridges, or beyond the sensor's range", 100 * plan.unseen_share));
  if (o.flight.density) {
    plan.below_density_share = share_of(plan.coverage.density, *o.flight.density * nadir_share(o.sensor.pattern));
    if (*plan.below_density_share > 0.0)
      plan.warnings.push_back(text("%.2f %% of the area gets fewer pulses than asked for", 100 * *plan.below_density_share));
  }
}

void add_cost(const PlanOptions& o, FlightPlan& plan) {
  const CostOptions& c = o.cost;
  const double usable = c.endurance.value - c.transit.value;
  if (usable <= 0.0) throw core::usage_error("the transit takes the whole endurance", "cost.endurance");
  double left = 0.0;
  for (const LineFound& l : plan.lines) {
    const double needed = l.seconds + l.turn_seconds;
    if (needed > usable)
      throw core::usage_error(l.line.name + " is longer than a sortie", "cost.endurance", "another direction, or split the area");
    if (needed > left) {
      ++plan.cost.sorties;
      left = usable;
    }
    left -= needed;
  }
  plan.cost.currency = c.currency;
  const auto sorties = static_cast<double>(plan.cost.sorties);
  plan.cost.hours = (plan.seconds + sorties * c.transit.value) / 3600.0;
  plan.cost.total = c.fixed + c.per_hour * plan.cost.hours + c.per_line * static_cast<double>(plan.lines.size()) + c.per_sortie * sorties;
}

}  // namespace

std::vector<BudgetFound> budgets_at(const core::SensorSigma& sensor, const TrajectorySigma& trajectory, double height, double speed,
                                    const std::vector<double>& angles) {
  std::vector<BudgetFound> out;
  for (const double angle : angles) {
    const ErrorBudget b = error_budget(sources_of(sensor, trajectory, height, angle, speed), height, angle);
    BudgetFound found{angle, height, {}, b.total()};
    for (size_t k = 0; k < source_names.size(); ++k) found.rows.push_back({std::string(source_names[k]), b.by_source[k].cwiseAbs()});
    out.push_back(std::move(found));
  }
  return out;
}

FlightPlan make_flight_plan(const PlanOptions& o, const std::vector<Ring>& area, const core::HeightField& ground) {
  if (!(area_of(area) > 1.0))
    throw core::usage_error("the area is empty: its corners lie on one line", "area", "are its corners in their order?");
  const Sensor s(o);
  const double height = height_of(o, s);
  check_ground(o, height, look_over(area, ground));
  const Layout layout =
      o.flight.pattern == PlanPattern::calibration ? calibration_of(o, s, area, ground) : lines_of(o, s, height, area, ground);
  FlightPlan plan;
  plan.name = o.name;
  plan.crs = o.crs;
  plan.area = area_of(area);
  plan.direction = layout.direction;
  plan.least_overlap = layout.least_overlap;
  for (const FlightLine& line : layout.lines) plan.lines.push_back(look_at(line, ground));
  check_heights(o, plan);
  add_times(o, s, plan.lines);
  double mean = 0.0;
  for (const LineFound& l : plan.lines) {
    plan.line_length += l.line.length();
    plan.seconds += l.seconds + l.turn_seconds;
    mean += l.mean * l.line.length();
  }
  mean /= plan.line_length;
  plan.swath = swath_of(o, s, mean);
  check_laser(o, s, ground, plan);
  add_bases(o, plan);
  add_coverage(o, s, area, ground, plan);
  core::SensorSigma sensor = o.sigma;
  if (sensor.beam_divergence.value == 0.0) sensor.beam_divergence = o.sensor.divergence;
  plan.budget = budgets_at(sensor, o.trajectory_sigma, mean, s.speed, {0.0, 0.5 * s.half_angle, s.half_angle});
  plan.photo = {photo_planimetry * mean, photo_height * mean, interval_of(mean, 1300), interval_of(mean, 2200), interval_of(mean, 2133)};
  add_cost(o, plan);
  return plan;
}

}  // namespace swath::planning
