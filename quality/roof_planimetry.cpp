// SPDX-License-Identifier: GPL-3.0-or-later
// The mean is that of random effects: each roof's covariance and a scatter between roofs, which is found from the weighted squares about
// the mean (the estimator of DerSimonian and Laird), so that its sigma holds for a cloud whose error differs from place to place.
#include "quality/roof_planimetry.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/statistics.h"

namespace swath::quality {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr size_t fewest_to_compare = 5;  // roofs: of fewer none is called changed by the others
constexpr double improbable = 20.0;      // chi-square of two components: by chance in one of 20 000 roofs
constexpr double known = 0.3;            // m, widest sigma of a mean's component

Matrix2d scattered(const Matrix2d& information, double between) {
  // Of (C + between^2 I): also where one component alone is known.
  const Eigen::SelfAdjointEigenSolver<Matrix2d> parts(information);
  Matrix2d out = Matrix2d::Zero();
  for (int k = 0; k < 2; ++k) {
    const double value = parts.eigenvalues()[k];
    if (value > 1e-9 * parts.eigenvalues()[1])
      out += 1.0 / (1.0 / value + between * between) * parts.eigenvectors().col(k) * parts.eigenvectors().col(k).transpose();
  }
  return out;
}

/// Roofs that lie far from the median of all, by their sigmas and by what roofs scatter.
void take_out_changed(std::vector<RoofShift>& shifts, std::vector<NamedFault>& named) {
  std::vector<double> east, north;
  for (const RoofShift& s : shifts)
    if (s.state == RoofState::both) east.push_back(s.shift.x()), north.push_back(s.shift.y());
  if (east.size() < fewest_to_compare) return;
  const Vector2d middle(core::median(east), core::median(north));
  std::vector<double> apart;
  for (size_t k = 0; k < east.size(); ++k)
    apart.push_back(std::abs(east[k] - middle.x())), apart.push_back(std::abs(north[k] - middle.y()));
  const double scatter = core::mad_to_sigma * core::median(apart);
  for (RoofShift& s : shifts) {
    if (s.state != RoofState::both) continue;
    const Vector2d d = s.shift - middle;
    const Matrix2d covariance = s.information.inverse();
    const double own = 0.5 * covariance.trace();
    // The scatter holds the sigmas of the roofs in it; a roof with larger ones than that has them in place of it.
    const Matrix2d all = covariance + std::max(0.0, scatter * scatter - own) * Matrix2d::Identity();
    if (d.dot(all.inverse() * d) <= improbable) continue;
    s.state = RoofState::disagrees;
    char text[160];
    std::snprintf(text, sizeof text, "lies %.2f m from where the other roofs place it (sigma %.2f m): it was changed, or surveyed wrongly",
                  d.norm(), std::sqrt(all.trace() / 2.0));
    named.push_back({"check.roof", "roof " + s.name + " " + text});
  }
}

/// Weighted mean; its information is 0 in a direction that no roof shows.
struct Mean {
  Vector2d at = Vector2d::Zero();
  Matrix2d information = Matrix2d::Zero();
};

Mean mean_of(const std::vector<RoofShift>& shifts, double between) {
  Mean m;
  Vector2d sum = Vector2d::Zero();
  for (const RoofShift& s : shifts) {
    if (!s.is_known()) continue;
    const Matrix2d weight = scattered(s.information, between);
    m.information += weight, sum += weight * s.shift;
  }
  m.at = m.information.completeOrthogonalDecomposition().solve(sum);
  return m;
}

/// Scatter between roofs that their sigmas do not explain, of one axis.
double scatter_between(const std::vector<RoofShift>& shifts, const Mean& fixed) {
  const Eigen::CompleteOrthogonalDecomposition<Matrix2d> fixed_by(fixed.information);
  double chi = 0.0, parts = -static_cast<double>(fixed_by.rank()), weights = 0.0;
  Matrix2d squares = Matrix2d::Zero();
  for (const RoofShift& s : shifts) {
    if (!s.is_known()) continue;
    const Vector2d d = s.shift - fixed.at;
    chi += d.dot(s.information * d);
    parts += s.state == RoofState::both ? 2.0 : 1.0;
    weights += s.information.trace();
    squares += s.information * s.information;
  }
  const double own = (Matrix2d(fixed_by.pseudoInverse()) * squares).trace();
  return parts > 0.0 && weights > own ? std::sqrt(std::max(0.0, (chi - parts) / (weights - own))) : 0.0;
}

void judge_rmse(const std::vector<RoofShift>& shifts, RoofPlanimetry& out) {
  if (out.roofs < fewest_roofs) return;
  Vector2d squares = Vector2d::Zero();
  double all = 0.0, of_targets = 0.0;
  const auto n = static_cast<double>(out.roofs);
  for (const RoofShift& s : shifts) {
    if (s.state != RoofState::both) continue;
    squares += s.shift.cwiseAbs2() / n;
    all += s.information.inverse().trace() / n, of_targets += 2.0 * s.target_sigma * s.target_sigma / n;
  }
  out.rmse_east = std::sqrt(squares.x()), out.rmse_north = std::sqrt(squares.y()), out.rmse = std::sqrt(squares.sum());
  out.measured_sigma = std::sqrt(std::max(0.0, all - of_targets)), out.target_sigma = std::sqrt(of_targets);
  const double left = squares.sum() - all;
  out.cloud = std::copysign(std::sqrt(std::abs(left)), left);
  out.with_targets = std::sqrt(squares.sum() + of_targets);
  // NSSDA (1998): 1.7308 RMSE_r where both axes are alike, 2.4477 of their mean otherwise, which is the same for those.
  const double half = 0.5 * of_targets;
  out.nssda = 2.4477 * 0.5 * (std::sqrt(squares.x() + half) + std::sqrt(squares.y() + half));
  out.is_enough = out.roofs >= enough_roofs;
}

std::string what_is_wrong(const RoofShift& s) {
  if (std::abs(s.wider) <= widest_rim) return " contradict one another: it was changed, or surveyed wrongly";
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                " lie %.2f m farther %s than surveyed on all sides: survey the eaves, not the walls, or it was changed", std::abs(s.wider),
                s.wider > 0.0 ? "out" : "in");
  return text.data();
}

}  // namespace

RoofPlanimetry planimetry_of(std::vector<RoofShift>& shifts, std::vector<NamedFault>& named) {
  for (const RoofShift& s : shifts)
    if (s.state == RoofState::disagrees) named.push_back({"check.roof", "the edges of roof " + s.name + what_is_wrong(s)});
  take_out_changed(shifts, named);
  RoofPlanimetry out;
  for (const RoofShift& s : shifts) {
    out.roofs += s.state == RoofState::both, out.one_component += s.state == RoofState::one;
    out.few_edges += s.state == RoofState::few_edges, out.not_there += s.state == RoofState::not_there;
    out.changed += s.state == RoofState::disagrees;
  }
  if (out.roofs + out.one_component == 0) return out;
  const Mean fixed = mean_of(shifts, 0.0);
  out.between = scatter_between(shifts, fixed);
  const Mean m = mean_of(shifts, out.between);
  const Eigen::SelfAdjointEigenSolver<Matrix2d> parts(m.information);
  const double least = 1.0 / (known * known);
  if (parts.eigenvalues()[0] > least) {
    const Matrix2d covariance = m.information.inverse();
    out.east = m.at.x(), out.north = m.at.y();
    out.sigma_east = std::sqrt(covariance(0, 0)), out.sigma_north = std::sqrt(covariance(1, 1));
  } else if (parts.eigenvalues()[1] > least) {
    const Vector2d best = best_direction(m.information);
    out.azimuth = azimuth_of(best);
    out.along = best.dot(m.at), out.sigma_along = 1.0 / std::sqrt(parts.eigenvalues()[1]);
  }
  judge_rmse(shifts, out);
  return out;
}

}  // namespace swath::quality
