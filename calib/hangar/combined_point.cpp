// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Jubanski et al., eq 4-8 and 10: D_A = Dh sin(beta) / (cos(gamma_A) sin(alpha + beta)), Dh the level distance of stations A and B,
// alpha at A, beta at B. Beyond the paper the stations' coordinates are observations with their covariance (held, they make sigmas of
// 0.06 mm out of 2 mm distances), all points are adjusted together, so that the stations' errors cancel in differences as they should,
// both sides of the stations' plane are tried, and vertical angles may make conditions for the height with their sign.
// Ceres was weighed: it has no conditions between observations (Gauss-Helmert), and observations as unknowns would hide their residuals'
// sigmas.
#include "calib/hangar/combined_point.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "calib/hangar/resection.h"

namespace swath::calib {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Kind = PointCondition::Kind;

constexpr int most_iterations = 100;
constexpr double converged = 1e-10;       // m
constexpr double same_place = 1e-4;       // m
constexpr double equal_fit = 25.0;        // five sigmas between two sums of squares
constexpr double rough_sigma = 0.005;     // m, of distances from triangles for start values; their relations matter little
constexpr double rough_elevation = 0.01;  // rad, of elevations between start values
constexpr double least_redundancy = 1e-6;

Index at(size_t i) { return static_cast<Index>(i); }

/// First column of a group of observations.
struct Columns {
  size_t verticals, distances, stations, end;
  explicit Columns(const PointNetwork& n)
      : verticals(n.angles.size()),
        distances(verticals + n.verticals.size()),
        stations(distances + n.distances.size()),
        end(stations + static_cast<size_t>(n.station_covariance.rows())) {}
};

MatrixXd covariance_of(const PointNetwork& n) {
  const Columns c(n);
  MatrixXd Q = MatrixXd::Zero(at(c.end), at(c.end));
  const auto set = [&](size_t k, double sigma) { Q(at(k), at(k)) = sigma * sigma; };
  for (size_t i = 0; i < n.angles.size(); ++i) set(i, n.angles[i].sigma);
  for (size_t i = 0; i < n.verticals.size(); ++i) set(c.verticals + i, n.verticals[i].sigma);
  for (size_t i = 0; i < n.distances.size(); ++i) set(c.distances + i, n.distances[i].sigma);
  const Index s = n.station_covariance.rows();
  Q.bottomRightCorner(s, s) = n.station_covariance;
  return Q;
}

/// The distance of the point from A (or from B) that the triangle gives.
double triangle_side(double level, double alpha, double beta, double elevation, Kind kind) {
  return level * std::sin(kind == Kind::from_a ? beta : alpha) / (std::cos(elevation) * std::sin(alpha + beta));
}

/// What a single point needs of a network.
PointNetwork part_of(const PointNetwork& n, size_t point) {
  PointNetwork out;
  out.points = 1;
  out.stations = n.stations;
  out.station_covariance = n.station_covariance;
  out.signed_elevations = n.signed_elevations;
  const auto copy = [point](const auto& from, auto& to) {
    for (auto o : from)
      if (o.point == point) {
        o.point = 0;
        to.push_back(o);
      }
  };
  copy(n.angles, out.angles);
  copy(n.verticals, out.verticals);
  copy(n.distances, out.distances);
  return out;
}

/// How well the signs and sizes of the vertical angles agree with a position: sum of squares.
double elevation_squares(const PointNetwork& n, const Vector3d& p) {
  double sum = 0;
  for (const VerticalAngle& v : n.verticals) {
    const Vector3d d = p - n.stations[v.at];
    sum += std::pow((v.angle - std::atan2(d.z(), d.head<2>().norm())) / std::hypot(v.sigma, rough_elevation), 2);
  }
  return sum;
}

/// How far the point moves, in its sigmas, by what its sights bend over one sigma of its least known direction (largest_bend).
double bend_of(const PointNetwork& n, const std::vector<PointCondition>& conditions, const CombinedPoints& a) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(a.covariance);
  const double variance = solver.eigenvalues()[2];
  const Vector3d direction = solver.eigenvectors().col(2), point = a.points;
  VectorXd bend = VectorXd::Zero(at(conditions.size()));
  for (size_t k = 0; k < conditions.size(); ++k) {
    if (conditions[k].kind == Kind::height) continue;  // straight in the height
    const Vector3d way = point - n.stations[conditions[k].kind == Kind::from_b ? conditions[k].b : conditions[k].a];
    bend[at(k)] = variance / (2 * way.norm()) * (1 - std::pow(direction.dot(way.normalized()), 2));
  }
  const Misclosures m = misclosures(n, conditions, a.points, observations_of(n) + a.residual);
  const Eigen::LLT<MatrixXd> M(m.by_observations * covariance_of(n) * m.by_observations.transpose());
  if (M.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  const Vector3d moved = m.by_points.transpose() * M.solve(bend);
  return std::sqrt(moved.dot(a.covariance * moved));
}

struct Candidate {
  CombinedPoints adjusted;
  double elevation = 0.0;
  Vector3d position() const { return adjusted.points; }
};

/// Distances that the conditions come to, roughly: where the search begins.
std::vector<TargetDistance> rough_distances(const PointNetwork& n, const std::vector<PointCondition>& conditions) {
  std::vector<TargetDistance> rough;
  for (const PointCondition& c : conditions) {
    if (c.kind == Kind::height) continue;
    if (c.kind == Kind::measured) {
      rough.push_back({n.stations[c.a], n.distances[c.other].distance, rough_sigma});
      continue;
    }
    const double level = (n.stations[c.a] - n.stations[c.b]).head<2>().norm();
    const double side = triangle_side(level, n.angles[c.alpha].angle, n.angles[c.beta].angle, n.verticals[c.other].angle, c.kind);
    rough.push_back({n.stations[c.kind == Kind::from_a ? c.a : c.b], side, rough_sigma});
  }
  return rough;
}

/// Which of two places is meant, the first one in the end: by the fit, then by vertical angles, then by where the search was to start.
void choose(std::vector<Candidate>& found, const std::optional<Vector3d>& start, PointSearch& out) {
  const bool both_fit = found[1].adjusted.solved && found[1].adjusted.squares - found[0].adjusted.squares < equal_fit;
  const double elevations = found[0].elevation - found[1].elevation;
  if (both_fit && std::abs(elevations) > equal_fit) {
    out.decided_by_elevation = true;
    if (elevations > 0) std::swap(found[0], found[1]);
  } else if (both_fit && start) {
    out.decided_by_start = true;
    if ((found[1].position() - *start).norm() < (found[0].position() - *start).norm()) std::swap(found[0], found[1]);
  } else if (both_fit) {
    out.state = PointState::two_fit;
  } else {
    out.elevations_contradict = elevations > equal_fit;
  }
  out.mirror = found[1].position();
  out.mirror_variance_factor = found[1].adjusted.squares / std::max(found[1].adjusted.redundancy, 1);
}

PointSearch search(const PointNetwork& n, const std::optional<Vector3d>& start) {
  PointSearch out;
  const std::vector<PointCondition> conditions = conditions_of(n);
  if (conditions.size() < 3) {
    out.state = PointState::too_few;
    return out;
  }
  const Resection begin = resect(rough_distances(n, conditions), start);
  if (begin.state == ResectionState::in_line || begin.state == ResectionState::too_few) {
    out.state = PointState::not_determined;
    return out;
  }
  std::vector<Candidate> found;
  const auto add = [&](const Vector3d& from) -> std::optional<Vector3d> {
    Candidate c;
    c.adjusted = adjust_points(n, from);
    if (!c.adjusted.points.allFinite() || !std::isfinite(c.adjusted.squares)) return std::nullopt;
    c.elevation = elevation_squares(n, c.position());
    const Vector3d end = c.position();
    for (const Candidate& f : found)
      if ((f.position() - end).norm() < same_place) return f.position();
    found.push_back(std::move(c));
    return end;
  };
  if (begin.state != ResectionState::not_found) add(begin.position);
  if (begin.mirror) add(*begin.mirror);
  const std::optional<Vector3d> from_start = start ? add(*start) : std::nullopt;
  // Those that did not converge come last: a mirror image that fits nothing may wander for ever.
  std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
    if (a.adjusted.solved != b.adjusted.solved) return a.adjusted.solved;
    return a.adjusted.squares < b.adjusted.squares;
  });
  if (found.empty() || !found[0].adjusted.solved) {
    // Beside the plane of the stations squares of heights come out below zero as often as above, and the search ends nowhere.
    const bool level = !n.verticals.empty() && std::all_of(n.verticals.begin(), n.verticals.end(),
                                                           [](const VerticalAngle& v) { return std::abs(v.angle) < rough_elevation; });
    if (begin.state == ResectionState::weak || level) out.state = PointState::weak;
    return out;
  }
  out.state = PointState::solved;
  if (found.size() > 1) {
    choose(found, start, out);
    out.start_led_to_mirror = from_start && (*from_start - found[0].position()).norm() > same_place;
  }
  out.position = found[0].position();
  if (!(bend_of(n, conditions, found[0].adjusted) < largest_bend)) out.state = PointState::weak;
  out.variance_factor = found[0].adjusted.squares / std::max(found[0].adjusted.redundancy, 1);
  return out;
}

}  // namespace

std::vector<PointCondition> conditions_of(const PointNetwork& n) {
  std::vector<PointCondition> out;
  for (size_t i = 0; i < n.angles.size(); ++i)
    for (size_t j = 0; j < n.angles.size(); ++j) {
      const HorizontalAngle &alpha = n.angles[i], &beta = n.angles[j];
      if (alpha.point != beta.point || alpha.at >= beta.at || alpha.to_station != beta.at || beta.to_station != alpha.at) continue;
      for (size_t k = 0; k < n.verticals.size(); ++k) {
        if (n.verticals[k].point != alpha.point) continue;
        if (n.verticals[k].at == alpha.at) out.push_back({Kind::from_a, alpha.point, alpha.at, beta.at, i, j, k});
        if (n.verticals[k].at == beta.at) out.push_back({Kind::from_b, alpha.point, alpha.at, beta.at, i, j, k});
      }
    }
  for (size_t k = 0; k < n.distances.size(); ++k)
    out.push_back({Kind::measured, n.distances[k].point, n.distances[k].at, n.distances[k].at, 0, 0, k});
  for (size_t k = 0; n.signed_elevations && k < n.verticals.size(); ++k)
    out.push_back({Kind::height, n.verticals[k].point, n.verticals[k].at, n.verticals[k].at, 0, 0, k});
  return out;
}

VectorXd observations_of(const PointNetwork& n) {
  const Columns c(n);
  VectorXd l(at(c.end));
  for (size_t i = 0; i < n.angles.size(); ++i) l[at(i)] = n.angles[i].angle;
  for (size_t i = 0; i < n.verticals.size(); ++i) l[at(c.verticals + i)] = n.verticals[i].angle;
  for (size_t i = 0; i < n.distances.size(); ++i) l[at(c.distances + i)] = n.distances[i].distance;
  if (c.end > c.stations)
    for (size_t s = 0; s < n.stations.size(); ++s) l.segment<3>(at(c.stations + 3 * s)) = n.stations[s];
  return l;
}

Misclosures misclosures(const PointNetwork& n, const std::vector<PointCondition>& conditions, const VectorXd& points, const VectorXd& l) {
  const Columns c(n);
  const bool held = c.end == c.stations;
  Misclosures out;
  out.value.resize(at(conditions.size()));
  out.by_points.setZero(at(conditions.size()), at(3 * n.points));
  out.by_observations.setZero(at(conditions.size()), l.size());
  const auto station = [&](size_t s) { return held ? n.stations[s] : Vector3d(l.segment<3>(at(c.stations + 3 * s))); };
  for (Index row = 0; row < out.value.size(); ++row) {
    const PointCondition& k = conditions[static_cast<size_t>(row)];
    auto by = out.by_observations.row(row);
    const auto add_station = [&](size_t s, const Eigen::RowVector3d& d) {
      if (!held) by.segment<3>(at(c.stations + 3 * s)) += d;
    };
    if (k.kind == Kind::height) {
      const Vector3d d = points.segment<3>(at(3 * k.point)) - station(k.a);
      const double level = d.head<2>().norm(), gamma = l[at(c.verticals + k.other)], tangent = std::tan(gamma);
      Eigen::RowVector3d by_point(0, 0, 1);
      by_point.head<2>() = -tangent / level * d.head<2>().transpose();
      out.value[row] = d.z() - level * tangent;
      out.by_points.row(row).segment<3>(at(3 * k.point)) = by_point;
      add_station(k.a, -by_point);
      by[at(c.verticals + k.other)] = -level * (1 + tangent * tangent);
      continue;
    }
    const size_t from = k.kind == Kind::from_b ? k.b : k.a;
    const DistanceModel m = distance_model(station(from), points.segment<3>(at(3 * k.point)));
    out.by_points.row(row).segment<3>(at(3 * k.point)) = -m.by_station;
    add_station(from, m.by_station);
    if (k.kind == Kind::measured) {
      out.value[row] = m.distance - l[at(c.distances + k.other)];
      by[at(c.distances + k.other)] = -1;
      continue;
    }
    const double alpha = l[at(k.alpha)], beta = l[at(k.beta)], gamma = l[at(c.verticals + k.other)];
    const Eigen::Vector2d base = (station(k.a) - station(k.b)).head<2>();
    const double level = base.norm();
    const double side = triangle_side(level, alpha, beta, gamma, k.kind);
    const double cot_sum = 1 / std::tan(alpha + beta), cot_own = 1 / std::tan(k.kind == Kind::from_a ? beta : alpha);
    out.value[row] = m.distance - side;  // eq 4-8
    by[at(k.alpha)] = side * (cot_sum - (k.kind == Kind::from_b ? cot_own : 0));
    by[at(k.beta)] = side * (cot_sum - (k.kind == Kind::from_a ? cot_own : 0));
    by[at(c.verticals + k.other)] = -side * std::tan(gamma);
    Eigen::RowVector3d stretch = Eigen::RowVector3d::Zero();
    stretch.head<2>() = side / (level * level) * base.transpose();
    add_station(k.a, -stretch);
    add_station(k.b, stretch);
  }
  return out;
}

CombinedPoints adjust_points(const PointNetwork& n, const VectorXd& start) {
  CombinedPoints out;
  const std::vector<PointCondition> conditions = conditions_of(n);
  const VectorXd observed = observations_of(n);
  const MatrixXd Q = covariance_of(n);
  out.points = start;
  out.residual.setZero(observed.size());
  out.redundancy = static_cast<int>(conditions.size()) - static_cast<int>(start.size());
  if (out.redundancy < 0) return out;
  MatrixXd unit_weights, BQ;
  for (out.iterations = 1; out.iterations <= most_iterations; ++out.iterations) {
    const Misclosures m = misclosures(n, conditions, out.points, observed + out.residual);
    if (!m.value.allFinite()) return out;
    BQ = m.by_observations * Q;
    const Eigen::LLT<MatrixXd> M(BQ * m.by_observations.transpose());
    if (M.info() != Eigen::Success) return out;
    const VectorXd w = m.value - m.by_observations * out.residual;
    const MatrixXd MA = M.solve(m.by_points);
    const Eigen::LLT<MatrixXd> N(m.by_points.transpose() * MA);
    if (N.info() != Eigen::Success) return out;
    const VectorXd step = N.solve(-MA.transpose() * w);
    const VectorXd correlates = -(M.solve(w) + MA * step);
    const VectorXd before = out.residual;
    out.points += step;
    out.residual = BQ.transpose() * correlates;
    out.squares = correlates.dot(M.matrixL() * (M.matrixU() * correlates));
    if (!out.points.allFinite() || !std::isfinite(out.squares)) return out;
    if (step.cwiseAbs().maxCoeff() > converged) continue;
    out.solved = true;
    out.covariance = N.solve(MatrixXd::Identity(start.size(), start.size()));
    unit_weights = M.solve(MatrixXd::Identity(M.rows(), M.rows())) - MA * out.covariance * MA.transpose();
    break;
  }
  if (!out.solved) return out;
  if (out.redundancy > 0) out.variance_factor = out.squares / out.redundancy;
  out.w.setZero(observed.size());
  for (Index i = 0; i < observed.size(); ++i) {
    const double variance = BQ.col(i).dot(unit_weights * BQ.col(i));
    if (variance > least_redundancy * Q(i, i)) out.w[i] = out.residual[i] / std::sqrt(variance);
  }
  return out;
}

FoundPoints find_points(const PointNetwork& n, const std::vector<std::optional<Vector3d>>& starts) {
  FoundPoints out;
  VectorXd start(at(3 * n.points));
  bool all = true;
  for (size_t p = 0; p < n.points; ++p) {
    out.searches.push_back(search(part_of(n, p), p < starts.size() ? starts[p] : std::nullopt));
    start.segment<3>(at(3 * p)) = out.searches.back().position;
    all = all && out.searches.back().state == PointState::solved;
  }
  if (all) out.adjusted = adjust_points(n, start);
  return out;
}

}  // namespace swath::calib
