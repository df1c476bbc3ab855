// SPDX-License-Identifier: GPL-3.0-or-later
// The other convention changes image points by c; the residuals r + c are adjusted by the same linear equations: with the normal equations
// N of A, squares = (r + c)'(r + c) - g' N^-1 g, g = A'(r + c), points eliminated one by one. Equations of the second order are left out,
// which is below a part in 10 000 of c: rays turn by less than a milliradian.
#include "calib/block/checks/held_values.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calib/block/block_normals.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// A difference of squares that a right convention reaches once in 20 000 blocks, whatever the size of the change.
constexpr double clearly_better = 15.0;

struct OtherCamera {
  std::uint32_t index = 0;
  std::string what, hint;
  BlockCamera camera;
};

void add_distortion(const BlockCamera& c, std::uint32_t index, std::vector<OtherCamera>& out) {
  constexpr int shape = camera_values - 3;  // k1 to b2
  if (!(c.sigma.tail<shape>().array() == held_value).all() || c.value.tail<shape>().isZero(0.0)) return;
  const bool ideal = c.distortion == DistortionAt::ideal;
  OtherCamera other{index, std::string("distortion = \"") + (ideal ? "measured" : "ideal") + "\"",
                    "check which point k1 to b2 are computed from", c};
  other.camera.distortion = ideal ? DistortionAt::measured : DistortionAt::ideal;
  out.push_back(other);
}

void add_principal_point(const BlockCamera& c, std::uint32_t index, std::vector<OtherCamera>& out) {
  const bool x = c.sigma[1] == held_value && c.value[1] != 0.0, y = c.sigma[2] == held_value && c.value[2] != 0.0;
  const auto add = [&](const char* name, double by_x, double by_y) {
    OtherCamera other{index, std::string("the opposite sign of ") + name,
                      "x0 counts to the right and y0 up from the middle of the sensor to the principal point", c};
    other.camera.value[1] *= by_x, other.camera.value[2] *= by_y;
    out.push_back(other);
  };
  if (x) add("x0", -1.0, 1.0);
  if (y) add("y0", 1.0, -1.0);
  if (x && y) add("x0 and y0", -1.0, -1.0);
}

VectorXd change_of(const ImageBlock& b, const LinearBlock& l, const BlockWeights& w, const OtherCamera& other) {
  VectorXd out = VectorXd::Zero(static_cast<Eigen::Index>(l.residual.size()));
  const BlockCamera& stated = b.cameras[other.index];
  for (const BlockObservation& o : l.observations) {
    if (o.kind != ObservationKind::ray || b.images[b.rays[o.index].image].camera != other.index) continue;
    const ImageRay& ray = b.rays[o.index];
    const BlockImage& image = b.images[ray.image];
    const Vector3d d = image.camera_R_local * (b.points[ray.point].position - image.position);
    const auto now = image_of(stated.value, stated.distortion, d), then = image_of(other.camera.value, other.camera.distortion, d);
    if (!now || !then) continue;
    const double root = std::sqrt(w.of_ray.empty() ? 1.0 : w.of_ray[o.index]);
    out.segment<2>(static_cast<Eigen::Index>(o.row)) = (*then - *now) * root / (ray.sigma * w.ray);
  }
  return out;
}

std::string sentence(const OtherCamera& other, double stated, double found) {
  char text[120];
  std::snprintf(text, sizeof text, ": weighted squares of the residuals are %.0f then, and %.0f as stated", found, stated);
  return "image points of camera " + other.camera.name + " fit better with " + other.what + text + "; " + other.hint;
}

}  // namespace

VectorXd adjusted_squares(const LinearBlock& l, const MatrixXd& residuals) {
  const BlockNormals normals(l);
  const NodeFactor factor(normals.reduced());
  MatrixXd right = MatrixXd::Zero(l.unknowns, residuals.cols());
  VectorXd taken = VectorXd::Zero(residuals.cols()), a;
  Vector3d b;
  const auto add = [&](const std::vector<int>& nodes, const std::vector<int>& begin, const MatrixXd& g) {
    for (size_t n = 0; n < nodes.size(); ++n) {
      const int size = begin[n + 1] - begin[n];
      right.middleRows(l.nodes[static_cast<size_t>(nodes[n])].first, size) += g.middleRows(begin[n], size);
    }
  };
  for (size_t p = 0; p < l.point_column.size(); ++p) {
    if (normals.observations_of(p).empty()) continue;
    const PointPart part = normals.part(p);
    MatrixXd g = MatrixXd::Zero(part.begin.back(), residuals.cols()), of_point = MatrixXd::Zero(3, residuals.cols());
    for (const std::uint32_t o : normals.observations_of(p))
      for (size_t row = l.observations[o].row; row < l.observations[o].row + static_cast<size_t>(l.observations[o].rows); ++row) {
        normals.row_of(row, part.nodes, part.begin, a, b);
        g += a * residuals.row(static_cast<Eigen::Index>(row));
        of_point += b * residuals.row(static_cast<Eigen::Index>(row));
      }
    add(part.nodes, part.begin, g - part.K * of_point);
    for (Eigen::Index k = 0; k < taken.size(); ++k) taken[k] += of_point.col(k).dot(part.inverse * of_point.col(k));
  }
  for (const std::uint32_t o : normals.others()) {
    const auto nodes = normals.nodes_of(l.observations[o]);
    const auto begin = normals.begins(nodes);
    for (size_t row = l.observations[o].row; row < l.observations[o].row + static_cast<size_t>(l.observations[o].rows); ++row) {
      normals.row_of(row, nodes, begin, a, b);
      add(nodes, begin, a * residuals.row(static_cast<Eigen::Index>(row)));
    }
  }
  const MatrixXd solved = factor.solve(right);
  VectorXd out(taken.size());
  for (Eigen::Index k = 0; k < out.size(); ++k) out[k] = residuals.col(k).squaredNorm() - taken[k] - right.col(k).dot(solved.col(k));
  return out;
}

std::vector<std::string> held_value_findings(ImageBlock b, const BlockWeights& weights) {
  std::vector<OtherCamera> others;
  for (std::uint32_t c = 0; c < b.cameras.size(); ++c)
    add_distortion(b.cameras[c], c, others), add_principal_point(b.cameras[c], c, others);
  if (others.empty()) return {};
  const LinearBlock l = BlockSystem(b, weights).linearise();
  const Eigen::Map<const VectorXd> stated(l.residual.data(), static_cast<Eigen::Index>(l.residual.size()));
  MatrixXd residuals(stated.size(), 1 + static_cast<Eigen::Index>(others.size()));
  residuals.col(0) = stated;
  double largest = 0.0;
  for (size_t k = 0; k < others.size(); ++k) {
    const VectorXd change = change_of(b, l, weights, others[k]);
    largest = std::max(largest, change.squaredNorm());
    residuals.col(1 + static_cast<Eigen::Index>(k)) = stated + change;
  }
  if (largest < clearly_better) return {};  // nothing that residuals could show
  const VectorXd squares = adjusted_squares(l, residuals);
  const double freedom = static_cast<double>(l.residual.size()) - l.unknowns - 3.0 * l.points();
  std::vector<std::string> out;
  for (std::uint32_t c = 0; c < b.cameras.size(); ++c) {
    size_t best = 0;
    for (size_t k = 0; k < others.size(); ++k)
      if (others[k].index == c && squares[1 + static_cast<Eigen::Index>(k)] < squares[static_cast<Eigen::Index>(best)]) best = k + 1;
    if (best == 0 || !(freedom > 0.0)) continue;
    const double least = squares[static_cast<Eigen::Index>(best)];
    if (squares[0] - least > clearly_better * std::max(1.0, least / freedom)) out.push_back(sentence(others[best - 1], squares[0], least));
  }
  return out;
}

}  // namespace swath::calib
