// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/roof_target.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/error.h"

namespace swath::calib {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

bool RoofTarget::holds(const Vector2d& p) const {
  for (size_t k = 0; k < corners.size(); ++k) {
    const Vector2d &a = corners[k], d = corners[(k + 1) % corners.size()] - a;
    if (d.x() * (p.y() - a.y()) - d.y() * (p.x() - a.x()) < 0.0) return false;
  }
  return true;
}

Vector2d RoofTarget::centre() const {
  Vector2d sum(0, 0);
  for (const Vector2d& c : corners) sum += c;
  return sum / static_cast<double>(corners.size());
}

RoofTarget roof_target(const std::string& name, const std::vector<Vector3d>& corners, double sigma_h, double sigma_v) {
  if (corners.size() < 3) throw core::Error{"target '" + name + "' has fewer than three corners", name, "survey all its corners"};
  RoofTarget t;
  t.name = name;
  t.sigma_h = sigma_h;
  t.sigma_v = sigma_v;
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& c : corners) mean += c / static_cast<double>(corners.size());
  t.frame = trajectory::local_frame(mean);
  MatrixXd A(corners.size(), 3);
  VectorXd up(corners.size());
  for (size_t k = 0; k < corners.size(); ++k) {
    const Vector3d p = t.frame.local_R_ecef * (corners[k] - mean);
    t.corners.push_back(p.head<2>());
    A.row(static_cast<Eigen::Index>(k)) << 1.0, p.x(), p.y();
    up[static_cast<Eigen::Index>(k)] = p.z();
  }
  t.plane = (A.transpose() * A).ldlt().solve(A.transpose() * up);
  const double area = t.area();
  if (area < 0.0) std::reverse(t.corners.begin(), t.corners.end());
  if (!t.holds(t.centre()) || std::abs(area) < 1.0)
    throw core::Error{"the corners of target '" + name + "' do not go around a convex roof", name,
                      "list them in their order around the roof"};
  for (size_t k = 0; k < corners.size(); ++k) {
    const Vector2d a = t.corners[k], b = t.corners[(k + 1) % corners.size()], c = t.corners[(k + 2) % corners.size()];
    if ((b - a).x() * (c - b).y() - (b - a).y() * (c - b).x() <= 0.0)
      throw core::Error{"the corners of target '" + name + "' do not go around a convex roof", name,
                        "list them in their order around the roof"};
  }
  return t;
}

RoofTarget::Side RoofTarget::side(size_t k) const {
  const Vector2d a = corners[k], b = corners[(k + 1) % corners.size()], d = (b - a).normalized();
  return {0.5 * (a + b), d, {d.y(), -d.x()}, (b - a).norm()};
}

double RoofTarget::area() const {
  double sum = 0.0;
  for (size_t k = 0; k < corners.size(); ++k) {
    const Vector2d a = corners[k], b = corners[(k + 1) % corners.size()];
    sum += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return sum;
}

}  // namespace swath::calib
