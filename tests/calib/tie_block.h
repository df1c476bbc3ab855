// SPDX-License-Identifier: GPL-3.0-or-later
// A small calibration flight whose planes are known exactly: ties for the adjustment, with the true trajectory and one with errors drawn
// from a covariance.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "calib/adjust/correction_knots.h"
#include "calib/adjust/tie_normals.h"
#include "calib/adjust/tie_system.h"
#include "calib/ties/tie_set.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "georef/shot_geometry.h"
#include "tests/calib/survey_support.h"
#include "tests/world/navigation.h"
#include "trajectory/trajectory.h"

namespace swath::calib::test {

using swath::test::Dice;

struct FlownLine {
  double heading = 0.0;                  // rad
  double across = 0.0;                   // m to starboard of the block's middle
  double height = 700.0;                 // m above it
  double length = 1200.0, speed = 60.0;  // m, m/s
  double duration() const { return length / speed; }
};

/// Opposite and crossed lines, two beside, two at another height.
inline std::vector<FlownLine> full_pattern() {
  return {{0.0, 0.0},   {180.0 * deg, 0.0},   {90.0 * deg, 0.0},  {270.0 * deg, 0.0},
          {0.0, 230.0}, {180.0 * deg, 230.0}, {0.0, 0.0, 1000.0}, {90.0 * deg, 0.0, 1000.0}};
}

struct World {
  trajectory::LocalFrame frame;
  std::vector<FlownLine> lines;
  std::vector<TiePlane> planes;
  core::Scanner scanner;
  core::Calibration truth;
  core::SensorSigma noise;
  core::TrajectoryData exact;
  double start = 2317.0 * 604800.0 + 100000.0;  // of the first line, s
  double pause = 120.0;                         // from the end of one line to the start of the next, s
  double margin = 2.0;                          // s flown before and after each line
  double widest = 25.0 * deg;
  int returns = 25;  // of each line on each plane

  double first(size_t line) const {
    double t = start;
    for (size_t k = 0; k < line; ++k) t += lines[k].duration() + pause;
    return t;
  }
};

inline Eigen::Vector3d direction_of(double heading) { return {std::sin(heading), std::cos(heading), 0.0}; }

/// Level and gently sloping ground, `buildings` gable roofs of all ridge directions.
inline std::vector<TiePlane> block_planes(int side, int buildings, std::uint64_t seed) {
  Dice dice(seed);
  std::vector<TiePlane> out;
  const auto add = [&](const Eigen::Vector3d& centre, double slope, double azimuth, double half, TieKind kind) {
    TiePlane p;
    p.centre = centre;
    p.normal = Eigen::Vector3d(std::sin(slope) * std::sin(azimuth), std::sin(slope) * std::cos(azimuth), std::cos(slope));
    p.half = {half, half};
    p.kind = kind;
    out.push_back(p);
  };
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const double x = 600.0 * ((i + dice.uniform()) / side - 0.5), y = 600.0 * ((j + dice.uniform()) / side - 0.5);
      add({x, y, 2.0 * dice.normal()}, 2.0 * deg * dice.uniform(), 360.0 * deg * dice.uniform(), 6.0, TieKind::ground);
    }
  for (int b = 0; b < buildings; ++b) {
    const double x = 600.0 * (dice.uniform() - 0.5), y = 600.0 * (dice.uniform() - 0.5), z = 6.0 + dice.normal();
    const double ridge = 180.0 * deg * dice.uniform(), slope = (20.0 + 20.0 * dice.uniform()) * deg;
    const Eigen::Vector3d away = direction_of(ridge + 90.0 * deg);
    add(Eigen::Vector3d(x, y, z) + 4.0 * away, slope, ridge + 90.0 * deg, 3.0, TieKind::roof);
    add(Eigen::Vector3d(x, y, z) - 4.0 * away, slope, ridge - 90.0 * deg, 3.0, TieKind::roof);
  }
  return out;
}

inline core::Calibration true_calibration() {
  core::Calibration c;
  c.roll = core::degrees(0.21);
  c.pitch = core::degrees(-0.33);
  c.heading = core::degrees(0.42);
  c.lever_arm_scanner = {core::Metres(0.2), core::Metres(-0.1), core::Metres(0.35)};
  c.range_offset = core::Metres(0.06);
  c.scan_scale = 1.00015;
  return c;
}

/// The flight with its exact trajectory.
inline World make_world(std::vector<FlownLine> lines, std::vector<TiePlane> planes) {
  World w;
  w.lines = std::move(lines);
  w.planes = std::move(planes);
  w.truth = true_calibration();
  w.noise.range = core::Metres(0.02);
  w.noise.scan_angle = core::degrees(0.001);
  w.frame = trajectory::local_frame(core::ecef_of({47.9 * deg, 10.5 * deg, 600.0}));
  for (size_t l = 0; l < w.lines.size(); ++l) {
    const FlownLine& f = w.lines[l];
    const double first = w.first(l);
    const int steps = static_cast<int>(std::lround((f.duration() + 2.0 * w.margin) / 0.05));
    for (int i = 0; i <= steps; ++i) {
      const double s = i * 0.05 - w.margin, phase = 0.7 * static_cast<double>(l);
      const Eigen::Vector3d local = (f.speed * s - 0.5 * f.length) * direction_of(f.heading) +
                                    f.across * direction_of(f.heading + 90.0 * deg) +
                                    Eigen::Vector3d(0.0, 0.0, f.height + 1.5 * std::sin(0.3 * s + phase));
      const core::Geodetic g = core::geodetic_of(w.frame.to_ecef(local));
      w.exact.time.push_back(first + s);
      w.exact.latitude.push_back(g.latitude);
      w.exact.longitude.push_back(g.longitude);
      w.exact.height.push_back(g.height);
      w.exact.roll.push_back(1.5 * deg * std::sin(0.5 * s + phase));
      w.exact.pitch.push_back(2.0 * deg + 0.8 * deg * std::sin(0.4 * s + 2.0 * phase));
      w.exact.heading.push_back(core::wrap_two_pi(f.heading + 1.5 * deg * std::sin(0.25 * s + phase)));
    }
  }
  return w;
}

/// Returns of every line on every plane within its swath, by the exact trajectory; ranges and angles with noise where `dice` is given.
inline TieSet ties_of(const World& w, Dice* dice, std::uint64_t places = 1) {
  Dice place(places);
  TieSet out;
  out.frame = w.frame;
  out.planes = w.planes;
  const trajectory::Trajectory trajectory(w.exact);
  const ShotGeometry geometry(w.scanner, w.truth);
  trajectory::Cursor cursor(trajectory);
  for (size_t l = 0; l < w.lines.size(); ++l)
    out.lines.push_back({static_cast<int>(l) + 1, w.first(l), w.first(l) + w.lines[l].duration()});
  for (size_t k = 0; k < w.planes.size(); ++k)
    for (size_t l = 0; l < w.lines.size(); ++l) {
      const FlownLine& f = w.lines[l];
      const TiePlane& p = w.planes[k];
      const Eigen::Vector3d along = direction_of(f.heading), starboard = direction_of(f.heading + 90.0 * deg);
      const double middle = (p.centre.dot(along) + 0.5 * f.length) / f.speed;
      const double angle = std::atan2(p.centre.dot(starboard) - f.across, f.height - p.centre.z());
      if (std::abs(angle) > w.widest || middle < 0.5 || middle > f.duration() - 0.5) continue;
      TieGroup g{static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(l), static_cast<std::uint32_t>(out.returns.size()), 0};
      std::vector<double> times;
      for (int i = 0; i < w.returns; ++i) times.push_back(w.first(l) + middle + p.half.x() / f.speed * (2.0 * place.uniform() - 1.0));
      std::sort(times.begin(), times.end());
      for (const double t : times) {
        const double a = angle + p.half.y() / f.height * (2.0 * place.uniform() - 1.0);
        const double roll = core::attitude_of(ecef_R_ned_at(*trajectory.pose_at(t)).transpose() * trajectory.pose_at(t)->ecef_R_body).roll;
        Return r{a - roll, 0.0, 500.0};
        cursor.seek(t + w.truth.latency.value);
        const trajectory::Pose pose = cursor.pose(t + w.truth.latency.value);
        // The point is linear in the range (no refraction): where it meets the plane.
        const auto distance = [&](double range) {
          r.range = range;
          return p.normal.dot(w.frame.local_R_ecef * (geometry.ecef_point(pose, r) - w.frame.origin) - p.centre);
        };
        const double near = distance(500.0), far = distance(1500.0);
        r.range = 500.0 + 1000.0 * near / (near - far);
        out.returns.time.push_back(t);
        out.returns.angle.push_back(r.angle + (dice ? w.noise.scan_angle.value * dice->normal() : 0.0));
        out.returns.forward.push_back(0.0);
        out.returns.range.push_back(r.range + (dice ? w.noise.range.value * dice->normal() : 0.0));
      }
      g.end = static_cast<std::uint32_t>(out.returns.size());
      out.groups.push_back(g);
    }
  return out;
}

/// Draws trajectory errors of a covariance at instants `step` apart in every line (from its first return on), linear between.
class ErrorDraw {
 public:
  ErrorDraw(const World& w, const ErrorCovariance& covariance, double step = 1.0) {
    const double before = step * std::ceil(w.margin / step);
    for (size_t l = 0; l < w.lines.size(); ++l)
      for (double s = -before; s < w.lines[l].duration() + w.margin + 0.999 * step; s += step) times_.push_back(w.first(l) + s);
    Eigen::MatrixXd C = covariance(times_);
    const Eigen::VectorXd tiny = 1e-9 * C.diagonal();
    C.diagonal() += tiny;
    const Eigen::VectorXd sigma = C.diagonal().cwiseSqrt();
    C = sigma.cwiseInverse().asDiagonal() * C * sigma.cwiseInverse().asDiagonal();
    root_ = sigma.asDiagonal() * Eigen::MatrixXd(C.llt().matrixL());
  }
  /// The exact trajectory with errors.
  core::TrajectoryData with_errors(const core::TrajectoryData& exact, Dice& dice) const {
    Eigen::VectorXd z(root_.rows());
    for (Eigen::Index i = 0; i < z.size(); ++i) z[i] = dice.normal();
    const Eigen::VectorXd e = root_ * z;
    return add(exact, [&](double t) {
      const auto k = std::min<size_t>(times_.size() - 2,
                                      static_cast<size_t>(std::upper_bound(times_.begin(), times_.end(), t + 1e-9) - times_.begin() - 1));
      const double share = (t - times_[k]) / (times_[k + 1] - times_[k]);
      return Correction((1.0 - share) * e.segment<6>(6 * k) + share * e.segment<6>(6 * k + 6));
    });
  }
  /// With any error given by time.
  template <class F>
  static core::TrajectoryData add(core::TrajectoryData d, const F& error) {
    for (size_t i = 0; i < d.size(); ++i) {
      const Correction e = error(d.time[i]);
      const core::Geodetic g{d.latitude[i], d.longitude[i], d.height[i]};
      const core::Geodetic moved =
          core::geodetic_of(core::ecef_of(g) + core::ecef_R_ned(g.latitude, g.longitude) * Eigen::Vector3d(e.head<3>()));
      d.latitude[i] = moved.latitude, d.longitude[i] = moved.longitude, d.height[i] = moved.height;
      d.roll[i] += e[3], d.pitch[i] += e[4], d.heading[i] += e[5];
    }
    return d;
  }

 private:
  std::vector<double> times_;
  Eigen::MatrixXd root_;
};

/// Errors such as a tactical IMU leaves: 2 and 3 cm, 0.003 deg, 0.006 deg, with correlation times of 60, 40 and 120 s.
inline Eigen::MatrixXd tactical_errors(const std::vector<double>& t) {
  const double sigma[6] = {0.02, 0.02, 0.03, 0.003 * deg, 0.003 * deg, 0.006 * deg}, tau[6] = {60.0, 60.0, 60.0, 40.0, 40.0, 120.0};
  const auto n = static_cast<Eigen::Index>(t.size());
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(6 * n, 6 * n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index c = 0; c < 6; ++c)
        C(6 * i + c, 6 * j + c) = sigma[c] * sigma[c] * std::exp(-std::abs(t[static_cast<size_t>(i)] - t[static_cast<size_t>(j)]) / tau[c]);
  return C;
}

/// A surveyed plane: four points on it with an error.
inline void survey(TiePlane& p, double sigma, Dice* dice) {
  const auto axes = plane_axes(p.normal);
  for (int k = 0; k < 4; ++k) {
    const double u = (k % 2 ? 1.0 : -1.0) * p.half.x(), v = (k / 2 ? 1.0 : -1.0) * p.half.y();
    p.control.push_back(
        {p.centre + u * axes[0] + v * axes[1] + (dice ? sigma * dice->normal() : 0.0) * p.normal, sigma, "C" + std::to_string(k + 1)});
  }
}

/// All that a linearisation needs, in one place.
struct TieBench {
  TieBench(World w, TieSet t, core::TrajectoryData data, const CorrectionOptions& corrections, std::vector<Parameter> globals)
      : world(std::move(w)),
        ties(std::move(t)),
        flown(std::move(data)),
        knots(ties.lines, world.truth.latency.value, corrections, tactical_errors) {
    problem = {&ties, &world.scanner, &flown, &knots, std::move(globals), RobustWeight(2.5, 6.0), 1};
    state = {world.truth, Eigen::VectorXd::Zero(knots.size()), ties.planes, std::vector<double>(ties.planes.size(), 0.0)};
  }
  /// Of the corrections as the knots have it, with some of the globals.
  TiePrior prior(const Eigen::VectorXd& globals, const Eigen::VectorXd& departure) const {
    const int unknowns = static_cast<int>(problem.globals.size());
    return TiePrior(problem, std::make_shared<UnknownNodes>(knots.nodes(unknowns)), {1, 1, 1}, {1, 1, 1}, state.correction, globals,
                    departure);
  }
  TieBench(const TieBench&) = delete;
  TieBench& operator=(const TieBench&) = delete;

  World world;
  TieSet ties;
  trajectory::Trajectory flown;
  CorrectionKnots knots;
  TieProblem problem;
  TieState state;
  TieNoise noise{0.02, 2e-5, 0.0, 0.0};
};

}  // namespace swath::calib::test
