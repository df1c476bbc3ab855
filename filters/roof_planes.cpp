// SPDX-License-Identifier: GPL-3.0-or-later
// Planes by RANSAC (Fischler & Bolles 1981; PCL's SampleConsensusModelPlane), one after the other, in overlapping windows of the survey's
// lattice, as Schnabel, Wahl & Klein 2007 ("Efficient RANSAC for point-cloud shape detection") localise their samples; each is fitted once
// more by least squares. The points of a window are sorted by their coordinates first and PCL draws from a fixed seed, so that planes
// depend on nothing but the window's points.
#include "filters/roof_planes.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/ransac.h>
#include <pcl/sample_consensus/sac_model_plane.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "filters/bins.h"
#include "filters/pcl_messages.h"

namespace swath::filters {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Model = pcl::SampleConsensusModelPlane<pcl::PointXYZ>;

constexpr double step = 3.0;          // m; a window spans two
constexpr double plan_cell = 2.0;     // m: raster of a plane's ground plan
constexpr size_t fewest = 8;          // returns of a plane
constexpr double own_share = 0.5;     // of all returns over the hull of its ground plan that lie on it
constexpr double last_share = 0.7;    // of its returns that are last ones
constexpr double least_upward = 0.5;  // cosine of the steepest plane's slope
constexpr int iterations = 200;
constexpr double certainty = 0.99;
constexpr int planes_given_up = 2;  // before a window is left
constexpr double rms_share = 0.6;   // of the tolerance: points evenly spread within it have 0.58

struct Plane {
  Vector3d point, normal;
  double distance(const Vector3d& p) const { return normal.dot(p - point); }
};

Plane fit(const std::vector<Vector3d>& points, const std::vector<size_t>& rows) {
  Vector3d mean = Vector3d::Zero();
  for (const size_t r : rows) mean += points[r];
  mean /= static_cast<double>(rows.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const size_t r : rows) spread += (points[r] - mean) * (points[r] - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  return {mean, axes.eigenvectors().col(0)};
}

double cross(const Vector2d& o, const Vector2d& a, const Vector2d& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

/// Convex hull, counter-clockwise (Andrew 1979).
std::vector<Vector2d> hull_of(std::vector<Vector2d> p) {
  std::sort(p.begin(), p.end(), [](const Vector2d& a, const Vector2d& b) { return std::tie(a.x(), a.y()) < std::tie(b.x(), b.y()); });
  std::vector<Vector2d> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const size_t start = hull.size();
    for (const Vector2d& q : p) {
      while (hull.size() >= start + 2 && cross(hull[hull.size() - 2], hull.back(), q) <= 0.0) hull.pop_back();
      hull.push_back(q);
    }
    hull.pop_back();
    std::reverse(p.begin(), p.end());
  }
  return hull;
}

/// All usable returns in plan.
class GroundPlan {
 public:
  explicit GroundPlan(const core::Block& b) : bins_(b, plan_cell, 0, [&b](size_t p) { return core::is_usable(b, p); }) {}

  /// Returns within the convex hull of the rows, its border included. What lies beside a roof does not tell against it.
  std::uint64_t returns_over(const core::Block& b, const std::vector<std::uint32_t>& rows) const {
    std::vector<Vector2d> plan;
    for (const std::uint32_t r : rows) plan.emplace_back(b.x[r], b.y[r]);
    const std::vector<Vector2d> hull = hull_of(plan);
    CellIndex low = cell_of(bins_.lattice(), b, rows.front()), high = low;
    for (const std::uint32_t r : rows) {
      const CellIndex c = cell_of(bins_.lattice(), b, r);
      low = {std::min(low.i, c.i), std::min(low.j, c.j)}, high = {std::max(high.i, c.i), std::max(high.j, c.j)};
    }
    std::uint64_t n = 0;
    for (int j = low.j; j <= high.j; ++j)
      for (int i = low.i; i <= high.i; ++i)
        for (const Bins::Point& q : bins_.in(i, j)) {
          bool inside = true;
          for (size_t k = 0; inside && k < hull.size(); ++k) inside = cross(hull[k], hull[(k + 1) % hull.size()], {q.x, q.y}) >= 0.0;
          n += inside;
        }
    return n;
  }

 private:
  Bins bins_;
};

class Window {
 public:
  Window(const core::Block& b, std::vector<std::uint32_t> rows) : block_(b), rows_(std::move(rows)) {
    std::sort(rows_.begin(), rows_.end(),
              [&](std::uint32_t p, std::uint32_t q) { return std::tie(b.x[p], b.y[p], b.z[p]) < std::tie(b.x[q], b.y[q], b.z[q]); });
    const Vector3d first(b.x[rows_[0]], b.y[rows_[0]], b.z[rows_[0]]);
    for (const std::uint32_t r : rows_) points_.emplace_back(Vector3d(b.x[r], b.y[r], b.z[r]) - first);
  }

  /// Marks the points of the window's planes.
  void mark(const GroundPlan& plan, double tolerance, std::vector<std::uint8_t>& planar) {
    std::vector<size_t> left(rows_.size());
    for (size_t k = 0; k < left.size(); ++k) left[k] = k;
    int given_up = 0;
    while (left.size() >= fewest && given_up < planes_given_up) {
      const std::vector<size_t> found = largest_plane(left, tolerance);
      if (found.size() < fewest) break;
      std::vector<std::uint32_t> rows;
      for (const size_t k : found) rows.push_back(rows_[k]);
      if (is_roof(found, rows, plan, tolerance)) {
        for (const std::uint32_t r : rows) planar[r] = 1;
      } else {
        ++given_up;
      }
      std::vector<size_t> rest;
      std::set_difference(left.begin(), left.end(), found.begin(), found.end(), std::back_inserter(rest));
      left = std::move(rest);
    }
  }

 private:
  std::vector<size_t> largest_plane(const std::vector<size_t>& among, double tolerance) const {
    const auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
    for (const size_t k : among) {
      const Eigen::Vector3f p = points_[k].cast<float>();
      cloud->emplace_back(p.x(), p.y(), p.z());
    }
    const auto model = std::make_shared<Model>(cloud);  // its own fixed seed
    pcl::RandomSampleConsensus<pcl::PointXYZ> ransac(model, tolerance);
    ransac.setMaxIterations(iterations);
    ransac.setProbability(certainty);
    if (!ransac.computeModel()) return {};
    pcl::Indices inliers;
    ransac.getInliers(inliers);
    if (inliers.size() < fewest) return {};
    std::vector<size_t> rows;
    for (const auto k : inliers) rows.push_back(among[static_cast<size_t>(k)]);
    const Plane plane = fit(points_, rows);
    rows.clear();
    for (const size_t k : among)
      if (std::abs(plane.distance(points_[k])) <= tolerance) rows.push_back(k);
    return rows;
  }

  bool is_roof(const std::vector<size_t>& found, const std::vector<std::uint32_t>& rows, const GroundPlan& plan, double tolerance) const {
    const Plane plane = fit(points_, found);
    if (std::abs(plane.normal.z()) < least_upward) return false;
    double squares = 0.0;
    size_t last = 0;
    for (const size_t k : found) {
      squares += plane.distance(points_[k]) * plane.distance(points_[k]);
      last += core::is_last_return(block_, rows_[k]);
    }
    const auto n = static_cast<double>(found.size());
    return std::sqrt(squares / n) <= rms_share * tolerance && static_cast<double>(last) >= last_share * n &&
           n >= own_share * static_cast<double>(plan.returns_over(block_, rows));
  }

  const core::Block& block_;
  std::vector<std::uint32_t> rows_;
  std::vector<Vector3d> points_;
};

}  // namespace

double planar_points_halo() { return 2.0 * step + plan_cell; }

std::vector<std::uint8_t> planar_points(const core::Block& b, const std::vector<std::uint8_t>& candidate, double tolerance) {
  std::vector<std::uint8_t> planar(b.size(), 0);
  if (b.size() == 0) return planar;
  silence_pcl();
  const GroundPlan plan(b);
  const Bins bins(b, step, 1, [&](size_t p) { return candidate[p] != 0; });
  const core::Lattice& l = bins.lattice();
  for (int j = 0; j + 1 < l.ny; ++j)
    for (int i = 0; i + 1 < l.nx; ++i) {
      std::vector<std::uint32_t> rows;
      for (int dj = 0; dj < 2; ++dj)
        for (int di = 0; di < 2; ++di) {
          const auto more = bins.rows(i + di, j + dj);
          rows.insert(rows.end(), more.begin(), more.end());
        }
      if (rows.size() >= fewest) Window(b, std::move(rows)).mark(plan, tolerance, planar);
    }
  return planar;
}

}  // namespace swath::filters
