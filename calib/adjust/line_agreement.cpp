// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/line_agreement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "calib/terms.h"
#include "core/statistics.h"
#include "georef/shot_geometry.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Row = Eigen::Matrix<double, 1, parameter_count>;

constexpr double sure = 3.5;            // standard normal deviates
constexpr size_t judged_together = 25;  // planes of a pair
constexpr std::uint32_t sampled = 40;   // returns of a group

/// One line on one plane.
struct Look {
  bool seen = false;
  double time = 0.0;      // GPS time, s
  double distance = 0.0;  // median of the returns' from the plane, m
  double variance = 0.0;  // of that by the returns' scatter, m^2
  Row by = Row::Zero();   // its derivatives by calibration and trajectory
};

Look look_of(const TieSet& ties, const TieGroup& g, const ShotGeometry& geometry, trajectory::Cursor& cursor) {
  const TiePlane& plane = ties.planes[g.plane];
  const Eigen::Matrix3d& local_R_ecef = ties.frame.local_R_ecef;
  std::vector<double> distances;
  Look out;
  const std::uint32_t n = g.end - g.begin, step = std::max(1u, n / sampled);
  for (std::uint32_t i = g.begin; i < g.end; i += step) {
    const double t = geometry.time(ties.returns.time[i]);
    if (!cursor.seek(t)) continue;
    Jacobian J;
    const Eigen::Vector3d point =
        geometry.ecef_point(cursor.pose(t), {ties.returns.angle[i], ties.returns.forward[i], ties.returns.range[i]}, J);
    if (!point.allFinite()) continue;
    distances.push_back(plane.normal.dot(local_R_ecef * (point - ties.frame.origin) - plane.centre));
    out.by += (plane.normal.transpose() * local_R_ecef) * J;
    out.time += t;
  }
  if (distances.size() < 4) return out;
  const auto count = static_cast<double>(distances.size());
  out.by /= count;
  out.time /= count;
  out.distance = core::median(distances);
  for (double& d : distances) d = std::abs(d - out.distance);
  constexpr double median_of_normal = 1.5708;  // its variance beside the mean's
  out.variance = median_of_normal * std::pow(core::mad_to_sigma * core::median(distances), 2) / count;
  out.seen = true;
  return out;
}

using Difference = std::pair<const Look*, const Look*>;

/// Covariance of the differences.
MatrixXd covariance_of(const std::vector<Difference>& all, const core::SensorSigma& sensor, const ErrorCovariance& errors) {
  const auto n = static_cast<Eigen::Index>(all.size());
  std::vector<double> times;
  MatrixXd by_errors = MatrixXd::Zero(n, 12 * n), by_calibration(n, latency + 1);
  VectorXd noise(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto& [a, b] = all[static_cast<size_t>(k)];
    by_errors.block<1, 6>(k, 12 * k) = a->by.segment<6>(position_north);
    by_errors.block<1, 6>(k, 12 * k + 6) = -b->by.segment<6>(position_north);
    by_calibration.row(k) = (a->by - b->by).head<latency + 1>();
    noise[k] = a->variance + b->variance;
    times.push_back(a->time);
    times.push_back(b->time);
  }
  MatrixXd out =
      by_errors * errors(times) * by_errors.transpose() + by_calibration * calibration_covariance(sensor) * by_calibration.transpose();
  out.diagonal() += noise;
  return out;
}

PairAgreement agreement_of(const std::vector<Difference>& all, const core::SensorSigma& sensor, const ErrorCovariance& errors) {
  PairAgreement out;
  out.planes = all.size();
  double squares = 0, judged = 0;
  for (const auto& [a, b] : all) {
    const double d = a->distance - b->distance;
    out.mean += d / static_cast<double>(all.size());
    squares += d * d;
  }
  out.rms = std::sqrt(squares / static_cast<double>(all.size()));
  std::vector<Difference> some;
  const size_t n = std::min(judged_together, all.size());
  for (size_t i = 0; i < n; ++i) some.push_back(all[i * all.size() / n]);
  for (const auto& [a, b] : some) judged += std::pow(a->distance - b->distance, 2);
  const MatrixXd C = covariance_of(some, sensor, errors);
  const double trace = C.trace(), freedom = trace * trace / C.squaredNorm();
  out.predicted = std::sqrt(trace / static_cast<double>(n));
  out.surplus = (std::cbrt(judged / trace) - (1 - 2 / (9 * freedom))) / std::sqrt(2 / (9 * freedom));
  return out;
}

}  // namespace

bool LineAgreement::exceeded() const {
  return std::any_of(pairs.begin(), pairs.end(), [](const PairAgreement& p) { return p.surplus > sure; });
}

LineAgreement line_agreement(const TieSet& ties, const core::Scanner& scanner, const core::Calibration& calibration,
                             const core::SensorSigma& sensor, const trajectory::Trajectory& trajectory, const ErrorCovariance& errors) {
  const ShotGeometry geometry(scanner, calibration);
  trajectory::Cursor cursor(trajectory);
  std::vector<Look> looks;
  for (const TieGroup& g : ties.groups) looks.push_back(look_of(ties, g, geometry, cursor));
  std::map<std::pair<int, int>, std::vector<Difference>> pairs;
  for (size_t first = 0, end = 0; first < looks.size(); first = end) {
    for (end = first; end < looks.size() && ties.groups[end].plane == ties.groups[first].plane;) ++end;
    for (size_t i = first; i < end; ++i)
      for (size_t j = i + 1; j < end; ++j) {
        if (ties.groups[i].line == ties.groups[j].line || !looks[i].seen || !looks[j].seen) continue;
        pairs[{ties.lines[ties.groups[i].line].id, ties.lines[ties.groups[j].line].id}].emplace_back(&looks[i], &looks[j]);
      }
  }
  LineAgreement out;
  double squares = 0, expected = 0;
  for (const auto& [ids, differences] : pairs) {
    PairAgreement p = agreement_of(differences, sensor, errors);
    p.line_a = ids.first;
    p.line_b = ids.second;
    const auto n = static_cast<double>(p.planes);
    out.planes += p.planes;
    squares += n * p.rms * p.rms;
    expected += n * p.predicted * p.predicted;
    out.pairs.push_back(p);
  }
  if (out.planes > 0) {
    out.rms = std::sqrt(squares / static_cast<double>(out.planes));
    out.predicted = std::sqrt(expected / static_cast<double>(out.planes));
  }
  return out;
}

}  // namespace swath::calib
