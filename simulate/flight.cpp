// SPDX-License-Identifier: GPL-3.0-or-later
// Course over time is a polynomial per piece; position is its integral, by Gauss and Legendre (8 nodes over at most 0.5 s: error
// below 1e-12 m). The plane is latitude and longitude times constants (radii at the origin), so lines are straight to 0.1 m per km
// and every derivative is closed. Turns between lines are the shortest turn-straight-turn path (Dubins 1957, CSC) with the smooth
// turns' own displacements, found by a scan and bisection of the first turn's angle.
#include "simulate/flight.h"

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

constexpr std::array<double, 4> gauss_x{0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
constexpr std::array<double, 4> gauss_w{0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};

// Smooth step of degree 7, its integral and its derivative, on [0, 1].
double step(double u) { return u * u * u * u * (35 + u * (-84 + u * (70 - 20 * u))); }
double step_integral(double u) { return u * u * u * u * u * (7 + u * (-14 + u * (10 - 2.5 * u))); }
double step_slope(double u) { return 140 * u * u * u * (1 - u) * (1 - u) * (1 - u); }

Vector2d unit(double course) { return {std::cos(course), std::sin(course)}; }  // north, east

}  // namespace

std::vector<LinePlan> plan_lines(const FlightOptions& flight, const WorldOptions& world, double half_angle, double convergence) {
  const double swath = 2 * flight.height.value * std::tan(half_angle);
  const double spacing = swath * (1 - flight.overlap);
  const double length = flight.line_length ? flight.line_length->value : world.length.value;
  const Vector2d along = unit(flight.direction.value + convergence), across(-along.y(), along.x());
  std::vector<LinePlan> plan;
  for (int i = 0; i < flight.lines; ++i) {
    const Vector2d middle = (i - 0.5 * (flight.lines - 1)) * spacing * across;
    const double sense = i % 2 ? -1.0 : 1.0;
    plan.push_back({middle - sense * 0.5 * length * along, middle + sense * 0.5 * length * along, "line " + std::to_string(i + 1)});
  }
  const double reach = (flight.lines - 1) * spacing + swath;
  for (int i = 0; i < flight.cross_lines; ++i) {
    const Vector2d middle = length * ((i + 0.5) / flight.cross_lines - 0.5) * along;
    const double sense = i % 2 ? -1.0 : 1.0;
    plan.push_back({middle - sense * 0.5 * reach * across, middle + sense * 0.5 * reach * across, "cross line " + std::to_string(i + 1)});
  }
  return plan;
}

Flight::Flight(const FlightOptions& options, const core::Geodetic& origin, double height, const std::vector<LinePlan>& plan,
               double wind_from, std::int64_t seed)
    : options_(options), origin_(origin), height_(height), wind_from_(wind_from) {
  metres_per_latitude_ = core::meridian_radius(origin.latitude) + height;
  metres_per_longitude_ = (core::prime_vertical_radius(origin.latitude) + height) * std::cos(origin.latitude);
  turn_rate_ = g0 * std::tan(options.bank.value) / options.speed.value;

  const double speed = options.speed.value, lead = options.lead.value;
  for (size_t i = 0; i < plan.size(); ++i) {
    const Vector2d way = plan[i].to - plan[i].from;
    const double course = std::atan2(way.y(), way.x());
    const Vector2d entry = plan[i].from - lead * speed * unit(course);
    if (i == 0) {
      at_ = entry;
      course_ = course;
    } else {
      fly_to(entry, course);
    }
    add_piece(lead, 0, 0);
    const double start = duration_;
    add_piece(way.norm() / speed, 0, 0);
    lines_.push_back({static_cast<int>(i) + 1, plan[i].name, start, duration_});
    add_piece(lead, 0, 0);
  }

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

Flight::Course Flight::course_of(const Piece& p, double since) {
  if (p.r0 == p.r1) return {p.course + p.r0 * since, p.r0, 0.0};
  const double u = since / p.duration, jump = p.r1 - p.r0;
  return {p.course + p.r0 * since + jump * p.duration * step_integral(u), p.r0 + jump * step(u), jump * step_slope(u) / p.duration};
}

Vector2d Flight::advance(const Piece& piece, double from, double to) const {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  Vector2d sum = Vector2d::Zero();
  for (size_t i = 0; i < 4; ++i)
    sum +=
        gauss_w[i] * (unit(course_of(piece, middle - half * gauss_x[i]).angle) + unit(course_of(piece, middle + half * gauss_x[i]).angle));
  return options_.speed.value * half * sum;
}

void Flight::add_piece(double duration, double r0, double r1) {
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
std::vector<double> Flight::turn_plan(double angle) const {
  const double full = turn_rate_ * ramp_;  // angle of a turn without hold
  if (std::abs(angle) <= full) return {ramp_, 0.0, angle / ramp_};
  return {ramp_, (std::abs(angle) - full) / turn_rate_, std::copysign(turn_rate_, angle)};
}

void Flight::add_turn(double angle) {
  if (angle == 0.0) return;
  const std::vector<double> t = turn_plan(angle);
  add_piece(t[0], 0, t[2]);
  if (t[1] > 0) add_piece(t[1], t[2], t[2]);
  add_piece(t[0], t[2], 0);
}

Vector2d Flight::turn_displacement(double angle, double& seconds) const {
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

void Flight::fly_to(const Vector2d& target, double course) {
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

const Flight::Piece& Flight::piece_at(double t) const {
  const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), t, [](double v, const Piece& p) { return v < p.start; });
  return after == pieces_.begin() ? pieces_.front() : *(after - 1);
}

Vector2d Flight::plane_position(const Piece& piece, double t) const {
  const double since = t - piece.start;
  if (piece.r0 == 0.0 && piece.r1 == 0.0) return piece.knots[0] + options_.speed.value * since * unit(piece.course);
  const auto last = static_cast<double>(piece.knots.size() - 1);
  const double k = std::clamp(std::floor(since / knot_step), 0.0, last);
  return piece.knots[static_cast<size_t>(k)] + advance(piece, k * knot_step, since);
}

Flight::Swing Flight::swing_of(const std::vector<Wave>& waves, double t) {
  Swing s;
  for (const Wave& w : waves) {
    const double c = w.amplitude * std::cos(w.omega * t + w.phase), v = w.amplitude * std::sin(w.omega * t + w.phase);
    s.value += v;
    s.rate += w.omega * c;
    s.acceleration -= w.omega * w.omega * v;
  }
  return s;
}

Pose Flight::pose(double t) const {
  const Piece& piece = piece_at(t);
  const Course course = course_of(piece, t - piece.start);
  const Vector2d p = plane_position(piece, t);
  const auto swing = [&](size_t k) {
    double v = 0.0;
    for (const Wave& w : shake_[k]) v += w.amplitude * std::sin(w.omega * t + w.phase);
    return v;
  };
  const double speed = options_.speed.value, crab = options_.wind.value / speed * std::sin(wind_from_ - course.angle);
  Pose out;
  out.position = {origin_.latitude + (p.x() + swing(0)) / metres_per_latitude_,
                  origin_.longitude + (p.y() + swing(1)) / metres_per_longitude_, height_ + swing(2)};
  out.attitude = {std::atan(speed * course.rate / g0) + swing(3), trim_pitch + swing(4),
                  core::wrap_two_pi(course.angle + std::asin(crab) + swing(5))};
  return out;
}

Motion Flight::motion(double t) const {
  const Piece& piece = piece_at(t);
  const Course course = course_of(piece, t - piece.start);
  const double speed = options_.speed.value;
  const Swing north = swing_of(shake_[0], t), east = swing_of(shake_[1], t), up = swing_of(shake_[2], t);
  const Swing roll = swing_of(shake_[3], t), pitch = swing_of(shake_[4], t), heading = swing_of(shake_[5], t);
  Motion m;
  m.pose = pose(t);
  const double lat = m.pose.position.latitude, h = m.pose.position.height;
  const double c = std::cos(course.angle), s = std::sin(course.angle);
  // Rates of latitude and longitude, then velocities with the radii of the place.
  const double lat1 = (speed * c + north.rate) / metres_per_latitude_;
  const double lat2 = (-speed * s * course.rate + north.acceleration) / metres_per_latitude_;
  const double lon1 = (speed * s + east.rate) / metres_per_longitude_;
  const double lon2 = (speed * c * course.rate + east.acceleration) / metres_per_longitude_;
  const double sin_lat = std::sin(lat), cos_lat = std::cos(lat);
  const double M = core::meridian_radius(lat), N = core::prime_vertical_radius(lat);
  const double w2 = 1 - core::wgs84::e2 * sin_lat * sin_lat;
  const double M_slope = 3 * M * core::wgs84::e2 * sin_lat * cos_lat / w2;  // dM / d latitude
  const double N_slope = N * core::wgs84::e2 * sin_lat * cos_lat / w2;      // dN / d latitude
  m.velocity = {lat1 * (M + h), lon1 * (N + h) * cos_lat, -up.rate};
  m.acceleration = {lat2 * (M + h) + lat1 * (M_slope * lat1 + up.rate),
                    lon2 * (N + h) * cos_lat + lon1 * ((N_slope * lat1 + up.rate) * cos_lat - (N + h) * sin_lat * lat1), -up.acceleration};
  const double bank = speed * course.rate / g0;
  const double share = options_.wind.value / speed, across = wind_from_ - course.angle;
  const double crab_rate = -share * std::cos(across) * course.rate / std::sqrt(1 - std::pow(share * std::sin(across), 2));
  m.attitude_rate = {speed * course.acceleration / g0 / (1 + bank * bank) + roll.rate, pitch.rate, course.rate + crab_rate + heading.rate};
  return m;
}

}  // namespace swath::simulate
