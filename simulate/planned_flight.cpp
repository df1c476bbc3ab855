// SPDX-License-Identifier: GPL-3.0-or-later
// Course over time is a polynomial per piece; position is its integral, by Gauss and Legendre (8 nodes over at most 0.5 s: error
// below 1e-12 m). Turns between lines are the shortest turn-straight-turn path (Dubins 1957, CSC) with the smooth
// turns' own displacements, found by a scan and bisection of the first turn's angle.
#include "simulate/planned_flight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "simulate/random.h"

namespace swath::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double g0 = 9.80665;
constexpr double trim_pitch = 2.0 * core::degree;
constexpr double knot_step = 0.5;  // s

// Departure: the steepest of each smooth step, and the time in which wind and turbulence set in after it leaves the ground.
constexpr double take_off_acceleration = 3.0, climb_rate = 8.0, set_in = 20.0;  // m/s^2, m/s, s
constexpr double height_at_rest = 2.0;                                          // m, IMU above the ground
constexpr double steepest = 35.0 / 16.0;                                        // slope of the smooth step at its middle

constexpr std::array<double, 4> gauss_x{0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
constexpr std::array<double, 4> gauss_w{0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};

// Smooth step of degree 7, its integral and its derivative, on [0, 1].
double step(double u) { return u * u * u * u * (35 + u * (-84 + u * (70 - 20 * u))); }
double step_integral(double u) { return u * u * u * u * u * (7 + u * (-14 + u * (10 - 2.5 * u))); }
double step_slope(double u) { return 140 * u * u * u * (1 - u) * (1 - u) * (1 - u); }

double step_curve(double u) { return 420 * u * u * (1 - u) * (1 - u) * (1 - 2 * u); }

Vector2d unit(double course) { return {std::cos(course), std::sin(course)}; }  // north, east

}  // namespace

PlannedFlight::PlannedFlight(const FlightOptions& options, const core::Geodetic& origin, double height, const std::vector<LinePlan>& plan,
                             double wind_from, std::int64_t seed)
    : options_(options), plane_(origin, height), height_(height), wind_from_(wind_from) {
  turn_rate_ = g0 * std::tan(options.bank.value) / options.speed.value;

  const double speed = options.speed.value, lead = options.lead.value;
  for (size_t i = 0; i < plan.size(); ++i) {
    const Vector2d way = plan[i].to - plan[i].from;
    const double course = std::atan2(way.y(), way.x());
    const Vector2d entry = plan[i].from - lead * speed * unit(course);
    if (i == 0) {
      add_departure(entry, course, plan[i].level);
    } else if (plan[i].level != plan[i - 1].level) {
      climb_to(entry, course, plan[i - 1].level, plan[i].level);
    } else {
      fly_to(entry, course);
    }
    add_piece(lead, 0, 0);
    const double start = duration_;
    add_piece(way.norm() / speed, 0, 0);
    lines_.push_back({static_cast<int>(i) + 1, plan[i].name, start, duration_, plan[i].scans});
    add_piece(lead, 0, 0);
  }
  const double rest = std::ceil(duration_ - 1e-9) - duration_;
  if (rest > 0) add_piece(rest, 0, 0);
  duration_ = std::round(duration_);

  // Amplitudes: m and rad at turbulence 1, spread over waves whose period falls; random phases.
  constexpr std::array<double, 6> amplitude{0.3, 0.3, 0.35, 0.9 * core::degree, 0.5 * core::degree, 0.4 * core::degree};
  constexpr std::array<double, 6> lowest{0.03, 0.03, 0.04, 0.08, 0.07, 0.05};  // Hz
  Random random = random_of(seed, Stream::turbulence);
  for (size_t k = 0; k < 6; ++k)
    for (int w = 0; w < 4; ++w) {
      const double f = lowest[k] * std::pow(2.1, w) * random.uniform(0.85, 1.15);
      const double a = options.turbulence * amplitude[k] * std::pow(0.55, k < 3 ? 1.6 * w : w) * random.uniform(0.7, 1.3);
      shake_[k].push_back({a, 2 * core::pi * f, random.uniform(0, 2 * core::pi)});
    }
}

void PlannedFlight::add_departure(const Vector2d& entry, double course, double level) {
  const double speed = options_.speed.value;
  course_ = course;
  at_ = entry;
  first_level_ = level;
  if (options_.still.value == 0.0) return;
  departure_.still = options_.still.value;
  departure_.run = steepest * speed / take_off_acceleration;
  const double rest = height_at_rest - options_.height.value;
  departure_.climb = steepest * (level - rest) / climb_rate;
  climbs_.push_back({departure_.still + departure_.run, departure_.climb, rest, level});
  pieces_.push_back(
      {0.0, departure_.duration(), course, 0.0, 0.0, {entry - speed * (0.5 * departure_.run + departure_.climb) * unit(course)}});
  duration_ = departure_.duration();
}

PlannedFlight::Course PlannedFlight::course_of(const Piece& p, double since) {
  if (p.r0 == p.r1) return {p.course + p.r0 * since, p.r0, 0.0};
  const double u = since / p.duration, jump = p.r1 - p.r0;
  return {p.course + p.r0 * since + jump * p.duration * step_integral(u), p.r0 + jump * step(u), jump * step_slope(u) / p.duration};
}

Vector2d PlannedFlight::advance(const Piece& piece, double from, double to) const {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  Vector2d sum = Vector2d::Zero();
  for (size_t i = 0; i < 4; ++i)
    sum +=
        gauss_w[i] * (unit(course_of(piece, middle - half * gauss_x[i]).angle) + unit(course_of(piece, middle + half * gauss_x[i]).angle));
  return options_.speed.value * half * sum;
}

void PlannedFlight::add_piece(double duration, double r0, double r1) {
  Piece p{duration_, duration, course_, r0, r1, {at_}};
  if (r0 == 0.0 && r1 == 0.0) {
    at_ += options_.speed.value * duration * unit(course_);
  } else {
    double from = 0.0;
    for (; from + knot_step < duration; from += knot_step) {
      at_ += advance(p, from, from + knot_step);
      p.knots.push_back(at_);
    }
    at_ += advance(p, from, duration);
  }
  course_ = course_of(p, duration).angle;
  duration_ += duration;
  pieces_.push_back(std::move(p));
}

/// Ramp, hold, peak rate of a turn by an angle.
std::vector<double> PlannedFlight::turn_plan(double angle) const {
  const double full = turn_rate_ * ramp_;  // angle of a turn without hold
  if (std::abs(angle) <= full) return {ramp_, 0.0, angle / ramp_};
  return {ramp_, (std::abs(angle) - full) / turn_rate_, std::copysign(turn_rate_, angle)};
}

void PlannedFlight::add_turn(double angle) {
  if (angle == 0.0) return;
  const std::vector<double> t = turn_plan(angle);
  add_piece(t[0], 0, t[2]);
  if (t[1] > 0) add_piece(t[1], t[2], t[2]);
  add_piece(t[0], t[2], 0);
}

Vector2d PlannedFlight::turn_displacement(double angle, double& seconds) const {
  // By the same pieces on a copy that has none yet.
  Vector2d at = Vector2d::Zero();
  double course = 0.0;
  seconds = 0.0;
  if (angle == 0.0) return at;
  const std::vector<double> t = turn_plan(angle);
  const std::array<std::array<double, 3>, 3> pieces{{{t[0], 0, t[2]}, {t[1], t[2], t[2]}, {t[0], t[2], 0}}};
  for (const auto& [duration, r0, r1] : pieces) {
    if (duration == 0.0) continue;
    const Piece p{0, duration, course, r0, r1, {}};
    const int n = static_cast<int>(std::ceil(duration / 1.0));
    for (int i = 0; i < n; ++i) at += advance(p, duration * i / n, duration * (i + 1) / n);
    course = course_of(p, duration).angle;
    seconds += duration;
  }
  return at;
}

void PlannedFlight::fly_to(const Vector2d& target, double course) {
  const auto turned = [](const Vector2d& v, double a) {
    return Vector2d(std::cos(a) * v.x() - std::sin(a) * v.y(), std::sin(a) * v.x() + std::cos(a) * v.y());
  };
  const double speed = options_.speed.value;
  const double change = std::remainder(course - course_, 2 * core::pi);
  // What is left across and along the straight leg after both turns, in the frame of the leg.
  double seconds = 0.0;
  const auto leg = [&](double first, double second) -> Vector2d {
    double s1 = 0, s2 = 0;
    const Vector2d d1 = turn_displacement(first, s1), d2 = turn_displacement(second, s2);
    seconds = s1 + s2;
    return turned(turned(target - at_, -course_) - d1, -first) - d2;
  };
  double best = std::numeric_limits<double>::infinity(), best_first = 0, best_second = 0, best_length = 0;
  constexpr double scan = 3 * core::degree;
  for (int k = -1; k <= 1; ++k) {
    const double total = change + 2 * core::pi * k;
    double previous = 0.0;
    for (int i = -120; i <= 120; ++i) {
      const double first = scan * i;
      if (std::abs(total - first) > 2 * core::pi) {
        previous = std::numeric_limits<double>::quiet_NaN();
        continue;
      }
      const double across = leg(first, total - first).y();
      if (i > -120 && previous * across <= 0) {
        double low = first - scan, high = first, at_low = previous;
        for (int b = 0; b < 60; ++b) {
          const double middle = 0.5 * (low + high), value = leg(middle, total - middle).y();
          if (at_low * value <= 0) {
            high = middle;
          } else {
            low = middle;
            at_low = value;
          }
        }
        const Vector2d rest = leg(low, total - low);
        const double time = seconds + rest.x() / speed;
        if (rest.x() >= 0 && std::abs(rest.y()) < 1e-3 && time < best) {
          best = time;
          best_first = low;
          best_second = total - low;
          best_length = rest.x();
        }
      }
      previous = across;
    }
  }
  if (!(best < std::numeric_limits<double>::infinity()))
    throw core::usage_error("no turn was found between two flight lines", "flight", "a longer lead or more bank");
  add_turn(best_first);
  if (best_length > 0) add_piece(best_length / speed, 0, 0);
  add_turn(best_second);
}

void PlannedFlight::climb_to(const Vector2d& target, double course, double from, double to) {
  const double needed = steepest * std::abs(to - from) / climb_rate, start = duration_;
  const size_t before = pieces_.size();
  const Vector2d at = at_;
  const double course_before = course_;
  fly_to(target, course);
  if (duration_ - start < needed) {
    // The way there is too short: full circles first.
    const std::vector<double> circle = turn_plan(2 * core::pi);
    const double circles = std::ceil((needed - (duration_ - start)) / (2 * circle[0] + circle[1]));
    pieces_.resize(before);
    at_ = at;
    course_ = course_before;
    duration_ = start;
    add_turn(2 * core::pi * circles);
    fly_to(target, course);
  }
  climbs_.push_back({start, duration_ - start, from, to});
}

const PlannedFlight::Piece& PlannedFlight::piece_at(double t) const {
  const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), t, [](double v, const Piece& p) { return v < p.start; });
  return after == pieces_.begin() ? pieces_.front() : *(after - 1);
}

PlannedFlight::Swing PlannedFlight::speed_at(double t) const {
  const double u = departure_.run > 0 ? std::clamp((t - departure_.still) / departure_.run, 0.0, 1.0) : 1.0;
  if (u >= 1.0) return {options_.speed.value, 0, 0};
  return {options_.speed.value * step(u), options_.speed.value * step_slope(u) / departure_.run, 0};
}

PlannedFlight::Swing PlannedFlight::climb_at(double t) const {
  const auto after = std::upper_bound(climbs_.begin(), climbs_.end(), t, [](double v, const Climb& c) { return v < c.start; });
  if (after == climbs_.begin()) return {climbs_.empty() ? first_level_ : after->from, 0, 0};
  const Climb& c = *(after - 1);
  const double u = std::min(1.0, (t - c.start) / c.duration), h = c.to - c.from;
  return {c.from + h * step(u), h * step_slope(u) / c.duration, h * step_curve(u) / (c.duration * c.duration)};
}

PlannedFlight::Swing PlannedFlight::share_at(double t) const {
  const double since = t - departure_.still - departure_.run, length = std::min(set_in, departure_.climb);
  if (departure_.still == 0.0 || since >= length) return {1, 0, 0};
  const double u = std::max(0.0, since / length);
  return {step(u), step_slope(u) / length, step_curve(u) / (length * length)};
}

Vector2d PlannedFlight::plane_position(const Piece& piece, double t) const {
  const double since = t - piece.start, speed = options_.speed.value;
  if (t < departure_.duration()) {
    const double run = departure_.run, u = std::clamp((since - departure_.still) / run, 0.0, 1.0);
    const double way = run * step_integral(u) + std::max(0.0, since - departure_.still - run);
    return piece.knots[0] + speed * way * unit(piece.course);
  }
  if (piece.r0 == 0.0 && piece.r1 == 0.0) return piece.knots[0] + speed * since * unit(piece.course);
  const auto last = static_cast<double>(piece.knots.size() - 1);
  const double k = std::clamp(std::floor(since / knot_step), 0.0, last);
  return piece.knots[static_cast<size_t>(k)] + advance(piece, k * knot_step, since);
}

PlannedFlight::Swing PlannedFlight::swing_of(const std::vector<Wave>& waves, double t) {
  Swing s;
  for (const Wave& w : waves) {
    const double c = w.amplitude * std::cos(w.omega * t + w.phase), v = w.amplitude * std::sin(w.omega * t + w.phase);
    s.value += v;
    s.rate += w.omega * c;
    s.acceleration -= w.omega * w.omega * v;
  }
  return s;
}

Pose PlannedFlight::pose(double t) const {
  const Piece& piece = piece_at(t);
  const Course course = course_of(piece, t - piece.start);
  const Vector2d p = plane_position(piece, t);
  const double share = share_at(t).value;
  const auto swing = [&](size_t k) {
    double v = 0.0;
    for (const Wave& w : shake_[k]) v += w.amplitude * std::sin(w.omega * t + w.phase);
    return share * v;
  };
  const double speed = options_.speed.value, crab = options_.wind.value / speed * std::sin(wind_from_ - course.angle);
  const Swing climb = climb_at(t);
  Pose out;
  out.position = plane_.geodetic_of({p.x() + swing(0), p.y() + swing(1), height_ + climb.value + swing(2)});
  out.attitude = {std::atan(speed * course.rate / g0) + swing(3), trim_pitch + climb.rate / speed + swing(4),
                  core::wrap_two_pi(course.angle + share * std::asin(crab) + swing(5))};
  return out;
}

Motion PlannedFlight::motion(double t) const {
  const Piece& piece = piece_at(t);
  const Course course = course_of(piece, t - piece.start);
  const double cruise = options_.speed.value;
  const Swing speed = speed_at(t), climb = climb_at(t), share = share_at(t);
  std::array<Swing, 6> swing;
  for (size_t k = 0; k < 6; ++k) {
    const Swing s = swing_of(shake_[k], t);
    swing[k] = {share.value * s.value, share.value * s.rate + share.rate * s.value,
                share.value * s.acceleration + 2 * share.rate * s.rate + share.acceleration * s.value};
  }
  const Vector2d p = plane_position(piece, t), along = unit(course.angle), across(-along.y(), along.x());
  const Vector2d v = speed.value * along, a = speed.rate * along + speed.value * course.rate * across;
  const double bank = cruise * course.rate / g0;
  const double into_wind = wind_from_ - course.angle, wind = options_.wind.value / cruise;
  const double crab = std::asin(wind * std::sin(into_wind));
  const double crab_rate = -wind * std::cos(into_wind) * course.rate / std::sqrt(1 - std::pow(wind * std::sin(into_wind), 2));
  LocalPlane::State s;
  s.position = {p.x() + swing[0].value, p.y() + swing[1].value, height_ + climb.value + swing[2].value};
  s.velocity = {v.x() + swing[0].rate, v.y() + swing[1].rate, climb.rate + swing[2].rate};
  s.acceleration = {a.x() + swing[0].acceleration, a.y() + swing[1].acceleration, climb.acceleration + swing[2].acceleration};
  s.attitude = {std::atan(bank) + swing[3].value, trim_pitch + climb.rate / cruise + swing[4].value,
                course.angle + share.value * crab + swing[5].value};
  s.attitude_rate = {cruise * course.acceleration / g0 / (1 + bank * bank) + swing[3].rate, climb.acceleration / cruise + swing[4].rate,
                     course.rate + share.value * crab_rate + share.rate * crab + swing[5].rate};
  return plane_.motion_of(s);
}

}  // namespace swath::simulate
