// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/clock/clock_windows.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/statistics.h"
#include "trajectory/ins/strapdown.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double window_length = 20.0;    // s
constexpr size_t most_cells = 1'000'000;  // triples times grid: 24 MB
constexpr size_t fewest_triples = 15;     // of a window: three equations each for 15 unknowns

/// Indices of fixes: the middle one and those half a span before and after it.
struct Three {
  size_t a, b, c;
};

std::vector<Three> threes_of(const core::GnssData& gnss, double half) {
  std::vector<Three> out;
  const auto& t = gnss.time;
  size_t a = 0, c = 0;
  double last = -1e300;
  for (size_t b = 0; b < t.size(); ++b) {
    if (t[b] - last < clock_spacing - 1e-6) continue;
    const auto nearest = [&t](size_t& k, double at) {
      while (k + 1 < t.size() && std::abs(t[k + 1] - at) <= std::abs(t[k] - at)) ++k;
    };
    nearest(a, t[b] - half);
    nearest(c, t[b] + half);
    constexpr double uneven = 0.3;
    if (std::abs(t[b] - t[a] - half) > uneven * half || std::abs(t[c] - t[b] - half) > uneven * half) continue;
    out.push_back({a, b, c});
    last = t[b];
  }
  return out;
}

using BySensors = Eigen::Matrix<double, 3, clock_sensor_errors>;

/// The IMU's double integral over a window, from identity at its beginning, and its derivatives by the sensors' errors.
class Integral {
 public:
  Integral(const ImuPath& path, double from, double until, const ClockSensorErrors& known) {
    ImuWalk walk(path, from);
    samples_.emplace_back();
    samples_.back().time = from;
    Increment piece;
    while (walk.next(until, piece)) {
      Sample next = samples_.back();
      piece.angle = (piece.angle - piece.step * known.segment<3>(0)).cwiseQuotient(Vector3d::Ones() + known.segment<3>(6));
      piece.velocity = (piece.velocity - piece.step * known.segment<3>(3)).cwiseQuotient(Vector3d::Ones() + known.segment<3>(9));
      const Vector3d push = next.turn * (piece.velocity + 0.5 * piece.angle.cross(piece.velocity));
      BySensors by;
      by << -core::skew(push) * next.turned.leftCols<3>(), piece.step * next.turn, -core::skew(push) * next.turned.rightCols<3>(),
          next.turn * piece.velocity.asDiagonal();
      samples_.back().force = push / piece.step;
      next.way += piece.step * (next.speed + 0.5 * push);
      next.speed += push;
      next.way_by += piece.step * (next.speed_by + 0.5 * by);
      next.speed_by += by;
      next.turned.leftCols<3>() += piece.step * next.turn;
      next.turned.rightCols<3>() += next.turn * piece.angle.asDiagonal();
      next.turn = next.turn * core::exp_so3(piece.angle);
      next.time = walk.time();
      samples_.push_back(next);
    }
  }
  /// What a gyro's bias and what its scale factors turn until then.
  const Eigen::Matrix<double, 3, 6>& turned(double t) const { return at(t).turned; }
  /// Twice integrated specific force and the turned lever arm.
  Vector3d place(double t, const Vector3d& lever) const {
    const Sample& s = at(t);
    const double d = t - s.time;
    return s.way + d * s.speed + 0.5 * d * d * s.force + (s.turn + share(s, t) * (after(s).turn - s.turn)) * lever;
  }
  /// Its derivatives by the sensors' errors, without those of the turned arm.
  BySensors place_by(double t) const {
    const Sample& s = at(t);
    return s.way_by + share(s, t) * (after(s).way_by - s.way_by);
  }

 private:
  struct Sample {
    double time = 0.0;
    Matrix3d turn = Matrix3d::Identity();
    Eigen::Matrix<double, 3, 6> turned = Eigen::Matrix<double, 3, 6>::Zero();  // of the body, by gyro bias (s) and gyro scale factor
    Vector3d speed = Vector3d::Zero(), way = Vector3d::Zero(), force = Vector3d::Zero();
    BySensors speed_by = BySensors::Zero(), way_by = BySensors::Zero();
  };
  const Sample& at(double t) const {
    auto later = std::upper_bound(samples_.begin(), samples_.end(), t, [](double x, const Sample& s) { return x < s.time; });
    return later == samples_.begin() ? samples_.front() : *(later - 1);
  }
  const Sample& after(const Sample& s) const { return *std::min(&s + 1, &samples_.back()); }
  double share(const Sample& s, double t) const {
    const double step = after(s).time - s.time;
    return step > 0 ? (t - s.time) / step : 0.0;
  }
  std::vector<Sample, Eigen::aligned_allocator<Sample>> samples_;
};

/// (c - b) / h2 - (b - a) / h1 over their mean step.
template <class V>
V second_difference(const V& a, const V& b, const V& c, double h1, double h2) {
  return ((c - b) / h2 - (b - a) / h1) / (0.5 * (h1 + h2));
}

/// The specific force that the fixes show, ecef axes at the middle fix.
Vector3d force_of(const core::GnssData& g, const Three& f) {
  const double h1 = g.time[f.b] - g.time[f.a], h2 = g.time[f.c] - g.time[f.b];
  const Vector3d velocity = (g.position[f.c] - g.position[f.a]) / (h1 + h2);
  const Vector3d earth(0, 0, core::wgs84::omega);
  return second_difference(g.position[f.a], g.position[f.b], g.position[f.c], h1, h2) + 2 * earth.cross(velocity) -
         gravity_at(g.position[f.b]);
}

ClockWindow window_of(const ImuPath& path, const core::GnssData& g, const std::vector<Three>& all, size_t first, size_t last,
                      const Vector3d& lever, const ClockGrid& grid, const ClockSensorErrors& known) {
  ClockWindow out;
  const double from = g.time[all[first].a] + grid.at(0) - 2 * clock_grid,
               until = g.time[all[last - 1].c] + grid.at(grid.offsets - 1) + 2 * clock_grid;
  if (from < path.begin() || until > path.end() || path.bridged_within(from, until).seconds > 0) return out;
  const Integral integral(path, from, until, known);
  const double middle = 0.5 * (g.time[all[first].b] + g.time[all[last - 1].b]);
  const Eigen::Matrix<double, 3, 6>& turned = integral.turned(middle + grid.middle);
  const core::Geodetic place = core::geodetic_of(g.position[all[(first + last) / 2].b]);
  const Matrix3d ned_R_ecef = core::ecef_R_ned(place.latitude, place.longitude).transpose();
  for (size_t n = first; n < last; ++n) {
    const Three& f = all[n];
    const double h1 = g.time[f.b] - g.time[f.a], h2 = g.time[f.c] - g.time[f.b];
    ClockTriple t;
    const Matrix3d inertial = Eigen::AngleAxisd(core::wgs84::omega * (g.time[f.b] - middle), Vector3d::UnitZ()).toRotationMatrix();
    t.force = ned_R_ecef * inertial * force_of(g, f);
    t.sensed.resize(grid.offsets);
    for (size_t i = 0; i < grid.offsets; ++i) {
      const double offset = grid.at(i);
      t.sensed[i] = second_difference(integral.place(g.time[f.a] + offset, lever), integral.place(g.time[f.b] + offset, lever),
                                      integral.place(g.time[f.c] + offset, lever), h1, h2);
    }
    t.by_sensors = second_difference(integral.place_by(g.time[f.a] + grid.middle), integral.place_by(g.time[f.b] + grid.middle),
                                     integral.place_by(g.time[f.c] + grid.middle), h1, h2);
    const Matrix3d across = core::skew(t.sensed[grid.offsets / 2]);
    t.by_sensors.leftCols<3>() += across * turned.leftCols<3>();
    t.by_sensors.middleCols<3>(6) += across * turned.rightCols<3>();
    out.triples.push_back(std::move(t));
    out.speed += (g.position[f.c] - g.position[f.a]).norm() / (h1 + h2) / static_cast<double>(last - first);
  }
  return out;
}

/// How much the force by the fixes varies within a stretch: spread between its quintiles, so that a stray fix counts for nothing.
double liveliness(const core::GnssData& g, const std::vector<Three>& all, size_t first, size_t last) {
  double sum = 0;
  std::array<std::vector<double>, 3> axis;
  for (size_t n = first; n < last; ++n) {
    const Vector3d f = force_of(g, all[n]);
    for (size_t i = 0; i < 3; ++i) axis[i].push_back(f[static_cast<Eigen::Index>(i)]);
  }
  for (auto& a : axis) sum += core::quantile(a, 0.8) - core::quantile(a, 0.2);
  return sum;
}

}  // namespace

std::vector<ClockWindow> clock_windows(const ImuPath& path, const core::GnssData& g, const Vector3d& lever, double step, double half_span,
                                       const ClockGrid& grid, const ClockSensorErrors& known) {
  const double length = window_length * std::max(1.0, step);
  const std::vector<Three> all = threes_of(g, std::max(half_span, step));
  struct Stretch {
    double liveliness;
    size_t first, last;
  };
  std::vector<Stretch> stretches;
  for (size_t first = 0, last; first < all.size(); first = last) {
    for (last = first; last < all.size() && g.time[all[last].b] - g.time[all[first].b] < length;) ++last;
    if (last - first >= fewest_triples) stretches.push_back({liveliness(g, all, first, last), first, last});
  }
  std::stable_sort(stretches.begin(), stretches.end(), [](const Stretch& a, const Stretch& b) { return a.liveliness > b.liveliness; });
  std::vector<ClockWindow> out;
  size_t cells = 0;
  for (const Stretch& s : stretches) {
    if (cells > most_cells) break;
    ClockWindow w = window_of(path, g, all, s.first, s.last, lever, grid, known);
    if (w.triples.empty()) continue;
    cells += w.triples.size() * (grid.offsets + clock_sensor_errors);
    out.push_back(std::move(w));
  }
  return out;
}

}  // namespace swath::trajectory
