// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/control.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "calib/words.h"
#include "core/error.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double farthest = 5e5;           // m: half of a long corridor
constexpr double off_plane = 4.0;          // sigmas
constexpr double least_redundancy = 1e-6;  // of a corner that the others check
constexpr int rounds = 3;                  // weights follow the normal, which they hardly move
constexpr const char* off_plane_count = "surveyed targets whose corners lie off one plane by more than four sigmas";

constexpr const char* crossing_count =
    "surveyed targets whose outline crosses itself: their corners do not stand in their order around them";

/// Do two sides of the outline cross, seen along the plane's normal?
bool crosses_itself(const SurveyedTarget& t) {
  const size_t n = t.corners.size();
  const auto side = [&](size_t from, size_t p) {
    return t.normal.dot((t.corners[(from + 1) % n] - t.corners[from]).cross(t.corners[p] - t.corners[from]));
  };
  for (size_t i = 0; i < n; ++i)
    for (size_t j = i + 2; j < n; ++j) {
      const size_t k = (j + 1) % n;
      if (k != i && side(i, j) * side(i, k) < 0 && side(j, i) * side(j, (i + 1) % n) < 0) return true;
    }
  return false;
}

Vector3d upwards(const Vector3d& n) { return n.z() < 0 ? Vector3d(-n) : n; }

void check_corners(const SurveyedTarget& target, const CornerPlane& plane, const std::vector<std::string>& places, core::Tally& tally) {
  size_t worst = 0;
  double w_worst = 0;
  for (size_t k = 0; k < plane.sigma.size(); ++k) {
    const double r = plane.redundancy[k];
    const double w = r < least_redundancy ? 0.0 : std::abs(plane.residual[k]) / (plane.sigma[k] * std::sqrt(r));
    if (w > w_worst) {
      w_worst = w;
      worst = k;
    }
  }
  if (w_worst <= off_plane) return;
  const std::string text =
      words(" lies %.3f m off the plane of the others (%.1f sigmas), ", std::abs(plane.residual[worst]) / plane.redundancy[worst], w_worst);
  const bool any_of_them = plane.sigma.size() == 4;
  tally.count(off_plane_count,
              target.name + ": " + (any_of_them ? "any one of its corners" : target.control[worst].name) + text + places[worst]);
}

}  // namespace

double sigma_along(const Vector3d& direction, double sigma_h, double sigma_v) {
  return std::hypot(sigma_h * direction.head<2>().norm(), sigma_v * direction.z());
}

CornerPlane corner_plane(const std::vector<Vector3d>& corners, const std::vector<double>& sigma_h, const std::vector<double>& sigma_v) {
  const size_t n = corners.size();
  CornerPlane out;
  out.sigma.assign(n, 1.0);
  Vector3d u, v;
  for (int round = 0; round < rounds; ++round) {
    double weights = 0;
    out.centre.setZero();
    for (size_t k = 0; k < n; ++k) {
      const double w = 1 / (out.sigma[k] * out.sigma[k]);
      out.centre += w * corners[k];
      weights += w;
    }
    out.centre /= weights;
    Matrix3d scatter = Matrix3d::Zero();
    for (size_t k = 0; k < n; ++k) {
      const Vector3d d = (corners[k] - out.centre) / out.sigma[k];
      scatter += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(scatter);
    out.normal = upwards(axes.eigenvectors().col(0));
    u = axes.eigenvectors().col(1);
    v = axes.eigenvectors().col(2);
    for (size_t k = 0; k < n; ++k) out.sigma[k] = sigma_along(out.normal, sigma_h[k], sigma_v[k]);
  }
  Matrix3d normal_matrix = Matrix3d::Zero();
  const auto row = [&](size_t k) {
    const Vector3d d = corners[k] - out.centre;
    return Vector3d(1.0, u.dot(d), v.dot(d));
  };
  for (size_t k = 0; k < n; ++k) normal_matrix += row(k) * row(k).transpose() / (out.sigma[k] * out.sigma[k]);
  const Eigen::LLT<Matrix3d> solver(normal_matrix);
  for (size_t k = 0; k < n; ++k) {
    out.residual.push_back(out.normal.dot(corners[k] - out.centre));
    out.redundancy.push_back(1.0 - row(k).dot(solver.solve(row(k))) / (out.sigma[k] * out.sigma[k]));
  }
  return out;
}

std::vector<SurveyedTarget> surveyed_targets(const std::vector<io::ControlPoint>& points, const trajectory::LocalFrame& frame,
                                             core::Tally& tally) {
  std::vector<SurveyedTarget> out;
  std::string far_place;  // of the first that is left out
  for (size_t first = 0, end = 0; first < points.size(); first = end) {
    const io::ControlPoint& p = points[first];
    end = first + 1;
    while (!p.target.empty() && end < points.size() && points[end].target == p.target) ++end;
    SurveyedTarget target;
    target.is_point = p.target.empty();
    target.name = target.is_point ? p.name : p.target;
    target.use = p.use;
    std::vector<double> sigma_h, sigma_v;
    std::vector<std::string> places;
    for (size_t k = first; k < end; ++k) {
      target.corners.push_back(frame.local_R_ecef * (points[k].ecef - frame.origin));
      target.control.push_back({target.corners.back(), points[k].sigma_v, points[k].name});
      sigma_h.push_back(points[k].sigma_h);
      sigma_v.push_back(points[k].sigma_v);
      places.push_back(points[k].place);
    }
    const auto far = std::find_if(target.corners.begin(), target.corners.end(), [](const Vector3d& c) { return !(c.norm() < farthest); });
    if (far != target.corners.end()) {
      const std::string text = words(": %.0f km from the survey", 1e-3 * far->norm());
      if (far_place.empty()) far_place = places[static_cast<size_t>(far - target.corners.begin())];
      tally.count("surveyed targets and points over 500 km from the survey, left out",
                  places[static_cast<size_t>(far - target.corners.begin())] + text);
      continue;
    }
    target.centre = target.corners[0];
    if (target.is_point) target.sigma_h = sigma_h[0];
    if (!target.is_point) {
      const CornerPlane plane = corner_plane(target.corners, sigma_h, sigma_v);
      target.centre = plane.centre;
      target.normal = plane.normal;
      for (size_t k = 0; k < plane.sigma.size(); ++k) target.control[k].sigma = plane.sigma[k];
      check_corners(target, plane, places, tally);
      if (crosses_itself(target)) tally.count(crossing_count, target.name + ", " + places[0]);
    }
    out.push_back(std::move(target));
  }
  if (out.empty() && !far_place.empty())
    throw core::Error("all surveyed targets and points lie over 500 km from the survey", far_place,
                      "check the CRS of the [[control]], and the order of easting and northing");
  return out;
}

}  // namespace swath::calib
