// SPDX-License-Identifier: GPL-3.0-or-later
// Axelsson 2000, "DEM generation from laser scanner data using adaptive TIN models", IAPRS 33 (B4/1), 110-117. Delaunay TIN by CGAL (exact
// predicates), updated point by point.
//
// Deviations. In brackets what each does to the mean total error over seven ISPRS samples, in points, where it was measured:
// - Thresholds are the options, the same in every round; the paper takes them from the medians of the TIN's own histograms. Not measured.
// - The scatter of the heights is taken off the distance before the angle is computed. Without it the angle of a point a step away from
//   a vertex is that of its noise (-3.9).
// - A mirrored point is the point's reflection in space (x, y and z) in the facet's highest vertex, which is right on slopes too. It is
//   tried where the facet is steeper than 30 degrees, that vertex is the nearest and the facet beyond is not steep: elsewhere it takes
//   roofs for ground (mirroring so: -4.0; without the condition on the facet beyond: -1.3; everywhere: worse than none).
// - The TIN grows in squares of the survey's own lattice with a margin (patches.h), so that no result depends on a tile's extent
//   (one TIN over a whole sample: +0.2).
// - Beyond the outermost seeds the TIN is held by made vertices, at the centres of the empty squares around, on the plane through the
//   ground points near by; the plane is renewed in every round. The paper does not say what is done there.
#include "filters/ground/ground_ptd.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/grid.h"
#include "filters/ground/patches.h"

namespace swath::filters {
namespace {

constexpr int patch_cells = 4;                                   // squares of the seeds
constexpr int margin_cells = 2;                                  // a facet of the first TIN is seldom longer
const double break_slope = std::tan(core::degrees(30.0).value);  // rise / run of a facet that hangs over a break

struct VertexInfo {
  double z = 0;
  bool made = false;  // not a measured point
};
struct FaceInfo {
  std::vector<std::uint32_t> points;  // that lie in the face and are not yet ground
  bool fresh = true;                  // points not yet judged against it
};
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<VertexInfo, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<FaceInfo, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>>;
using Face = Delaunay::Face_handle;
using Vertex = Delaunay::Vertex_handle;
using Vector = Eigen::Vector3d;

Vector place(Vertex v) { return {v->point().x(), v->point().y(), v->info().z}; }

/// Sums of points, from which the plane through them follows.
struct PlaneSums {
  double n = 0;
  Vector sum = Vector::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();

  void add(const Vector& p) {
    ++n;
    sum += p;
    squares += p * p.transpose();
  }
  void add(const PlaneSums& o) {
    n += o.n;
    sum += o.sum;
    squares += o.squares;
  }
  /// Height of the plane at (x, y); none where the points spread by less than `spread` across their own line.
  std::optional<double> height(double x, double y, double spread) const {
    const Vector mean = sum / n;
    const Eigen::Matrix3d c = squares / n - mean * mean.transpose();
    const double half_trace = 0.5 * (c(0, 0) + c(1, 1));
    const double least = half_trace - std::hypot(0.5 * (c(0, 0) - c(1, 1)), c(0, 1));
    if (!(least > spread * spread)) return std::nullopt;
    const Eigen::Vector2d slope = c.topLeftCorner<2, 2>().inverse() * c.block<2, 1>(0, 2);
    return mean.z() + slope.dot(Eigen::Vector2d(x, y) - mean.head<2>());
  }
};

/// How well a point fits the ground; the smallest goes first.
struct Fit {
  double angle = 0;  // rad
  double away = 0;   // m to the nearest vertex
  std::uint32_t point = 0;
  Face face;

  bool operator<(const Fit& o) const {
    if (angle != o.angle) return angle < o.angle;
    return away != o.away ? away > o.away : point < o.point;
  }
};

/// The TIN of one patch. Points are known by their index in `points`.
class GroundTin {
 public:
  /// `points` relative to the south-west corner of the squares, no two at one (x, y), in lexicographic order; `cells` squares of the seeds
  /// in each direction, the outermost of them empty.
  GroundTin(const std::vector<Vector>& points, int cells, const PtdOptions& o) : points_(points), cells_(cells), o_(o) {
    ground_.assign(points.size(), false);
    sums_.resize(static_cast<size_t>(cells * cells));
    plant_seeds();
  }

  std::vector<bool> densify() {
    bool all_judged = true;
    while (true) {
      hold_rim();
      const std::vector<Fit> best = best_of_faces();
      for (const Fit& f : best) insert(f.point, f.face);
      if (!best.empty()) {
        all_judged = false;
        continue;
      }
      if (all_judged) return ground_;
      // A mirrored point is judged by a face that may have changed while its own did not.
      for (const Face f : tin_.finite_face_handles()) f->info().fresh = true;
      all_judged = true;
    }
  }

 private:
  size_t cell_of(const Vector& p) const {
    const auto index = [&](double v) { return static_cast<size_t>(std::clamp(static_cast<int>(v / o_.building.value), 0, cells_ - 1)); };
    return index(p.y()) * static_cast<size_t>(cells_) + index(p.x());
  }

  void plant_seeds() {
    std::vector<std::optional<std::uint32_t>> lowest(sums_.size());
    for (std::uint32_t k = 0; k < points_.size(); ++k) {
      auto& seed = lowest[cell_of(points_[k])];
      if (!seed || points_[k].z() < points_[*seed].z()) seed = k;
    }
    const auto planted = [&](int i, int j) {
      return i >= 0 && j >= 0 && i < cells_ && j < cells_ && lowest[static_cast<size_t>(j * cells_ + i)].has_value();
    };
    for (int j = 0; j < cells_; ++j)
      for (int i = 0; i < cells_; ++i) {
        if (const auto seed = lowest[static_cast<size_t>(j * cells_ + i)]) {
          add_vertex(points_[*seed], false);
          ground_[*seed] = true;
          continue;
        }
        bool beside = false;
        for (int dj = -1; dj <= 1; ++dj)
          for (int di = -1; di <= 1; ++di) beside = beside || planted(i + di, j + dj);
        if (beside) rim_.push_back(add_vertex({(i + 0.5) * o_.building.value, (j + 0.5) * o_.building.value, 0.0}, true));
      }
    Face near;
    for (std::uint32_t k = 0; k < points_.size(); ++k) {
      if (ground_[k]) continue;
      near = tin_.locate({points_[k].x(), points_[k].y()}, near);
      near->info().points.push_back(k);
    }
  }

  Vertex add_vertex(const Vector& p, bool made, Face near = {}) {
    const Vertex v = tin_.insert({p.x(), p.y()}, near);
    v->info() = {p.z(), made};
    if (!made) sums_[cell_of(p)].add(p);
    return v;
  }

  /// Sets the made vertices on the plane through the ground points of the squares around.
  void hold_rim() {
    constexpr double change = 0.01;      // m: less is not judged anew
    constexpr double spread = 0.2;       // of a square
    constexpr double enough_near = 6.0;  // points in the eight squares around, or those behind them are taken too
    for (const Vertex v : rim_) {
      const Vector p = place(v);
      const int i = static_cast<int>(p.x() / o_.building.value), j = static_cast<int>(p.y() / o_.building.value);
      double z = 0;
      for (int reach = 1; reach <= 2; ++reach) {
        PlaneSums around;
        for (int b = std::max(j - reach, 0); b <= std::min(j + reach, cells_ - 1); ++b)
          for (int a = std::max(i - reach, 0); a <= std::min(i + reach, cells_ - 1); ++a)
            around.add(sums_[static_cast<size_t>(b * cells_ + a)]);
        const auto plane =
            around.n >= (reach == 1 ? enough_near : 3.0) ? around.height(p.x(), p.y(), spread * o_.building.value) : std::nullopt;
        if (reach == 1 || plane) z = plane.value_or(around.sum.z() / around.n);
        if (plane) break;
      }
      if (std::abs(z - v->info().z) < change) continue;
      v->info().z = z;
      auto f = tin_.incident_faces(v);
      const auto first = f;
      do f->info().fresh = true;
      while (++f != first);
    }
  }

  /// One point for each face that has points which fit.
  std::vector<Fit> best_of_faces() {
    std::vector<Fit> out;
    for (const Face f : tin_.finite_face_handles()) {
      if (!f->info().fresh) continue;
      f->info().fresh = false;
      std::optional<Fit> best;
      for (const std::uint32_t k : f->info().points) {
        if (ground_[k]) continue;
        const auto fit = judge(f, k);
        if (fit && (!best || *fit < *best)) best = fit;
      }
      if (best) out.push_back(*best);
    }
    std::sort(out.begin(), out.end(), [](const Fit& a, const Fit& b) { return a.point < b.point; });
    return out;
  }

  std::optional<Fit> judge(Face f, std::uint32_t k) {
    const Vector& p = points_[k];
    auto fit = fit_to(f, p);
    if (!fit && o_.mirror) {
      const Vertex top = highest(f);
      const bool at_break = p.z() > height_on(f, p) && is_steep(f) && is_nearest(f, top, p);
      if (at_break && !top->info().made) {
        const Vector mirrored = 2.0 * place(top) - p;
        const Face there = tin_.locate({mirrored.x(), mirrored.y()}, f);
        if (!tin_.is_infinite(there) && !has_made_vertex(there) && !is_steep(there)) fit = fit_to(there, mirrored);
      }
    }
    if (fit) fit->point = k, fit->face = f;
    return fit;
  }

  /// Distance from the facet and angles at its vertices within the limits, or nothing.
  std::optional<Fit> fit_to(Face f, const Vector& p) const {
    const Vector a = place(f->vertex(0));
    const Vector normal = (place(f->vertex(1)) - a).cross(place(f->vertex(2)) - a).normalized();
    const double distance = std::abs(normal.dot(p - a));
    if (!(distance <= o_.distance.value)) return std::nullopt;
    double away = -1.0, made_away = -1.0;
    for (int i = 0; i < 3; ++i) {
      const double d = (place(f->vertex(i)) - p).norm();
      double& least = f->vertex(i)->info().made ? made_away : away;
      if (least < 0 || d < least) least = d;
    }
    if (away < 0) away = made_away;
    const double excess = std::max(distance - o_.scatter.value, 0.0);
    const double angle = excess < away ? std::asin(excess / away) : 0.5 * core::pi;
    if (!(angle <= o_.angle.value)) return std::nullopt;
    return Fit{angle, away, 0, {}};
  }

  static Vertex highest(Face f) {
    Vertex top = f->vertex(0);
    for (int i = 1; i < 3; ++i)
      if (f->vertex(i)->info().z > top->info().z) top = f->vertex(i);
    return top;
  }
  static bool is_steep(Face f) {
    const Vector a = place(f->vertex(0));
    const Vector n = (place(f->vertex(1)) - a).cross(place(f->vertex(2)) - a);
    return n.head<2>().norm() > break_slope * std::abs(n.z());
  }
  static bool is_nearest(Face f, Vertex v, const Vector& p) {
    const double d = (place(v) - p).head<2>().squaredNorm();
    for (int i = 0; i < 3; ++i)
      if ((place(f->vertex(i)) - p).head<2>().squaredNorm() < d) return false;
    return true;
  }
  static bool has_made_vertex(Face f) { return f->vertex(0)->info().made || f->vertex(1)->info().made || f->vertex(2)->info().made; }
  static double height_on(Face f, const Vector& p) {
    const Vector a = place(f->vertex(0));
    const Vector n = (place(f->vertex(1)) - a).cross(place(f->vertex(2)) - a);
    return a.z() - (n.x() * (p.x() - a.x()) + n.y() * (p.y() - a.y())) / n.z();
  }

  /// Makes point k a vertex and gives the points of the faces that go to the faces that come.
  void insert(std::uint32_t k, Face near) {
    const Kernel::Point_2 p(points_[k].x(), points_[k].y());
    Delaunay::Locate_type type;
    int index = 0;
    const Face at = tin_.locate(p, type, index, near);
    std::vector<Face> gone;
    if (type != Delaunay::VERTEX) tin_.get_conflicts(p, std::back_inserter(gone), at);
    std::vector<std::uint32_t> homeless;
    for (const Face f : gone) {
      homeless.insert(homeless.end(), f->info().points.begin(), f->info().points.end());
      f->info().points.clear();
    }
    ground_[k] = true;
    if (type == Delaunay::VERTEX) return;  // a made vertex stands there
    const Vertex v = add_vertex(points_[k], false, at);
    std::vector<Face> star;
    auto f = tin_.incident_faces(v);
    const auto first = f;
    do {
      f->info().points.clear();
      f->info().fresh = true;
      star.push_back(f);
    } while (++f != first);
    for (const std::uint32_t q : homeless)
      if (q != k) face_around(v, star, q)->info().points.push_back(q);
  }

  Face face_around(Vertex v, const std::vector<Face>& star, std::uint32_t q) const {
    const Kernel::Point_2 p(points_[q].x(), points_[q].y());
    for (const Face f : star) {
      const int i = f->index(v);
      const auto side = [&](int w) { return CGAL::orientation(v->point(), f->vertex(w)->point(), p); };
      if (side(Delaunay::ccw(i)) != CGAL::RIGHT_TURN && side(Delaunay::cw(i)) == CGAL::RIGHT_TURN) return f;
    }
    return star.front();
  }

  const std::vector<Vector>& points_;
  const int cells_;
  const PtdOptions& o_;
  Delaunay tin_;
  std::vector<bool> ground_;
  std::vector<PlaneSums> sums_;  // of the ground points, per square
  std::vector<Vertex> rim_;      // made vertices
};

Patching patching(const PtdOptions& o) { return {patch_cells * o.building.value, margin_cells * o.building.value}; }

}  // namespace

double halo(const PtdOptions& o) { return patching(o).halo(); }

GroundCounts classify_ground_ptd(core::Block& b, size_t own, const PtdOptions& o) {
  std::vector<Verdict> verdicts(b.size(), Verdict::object);
  const auto takes_part = [&b](size_t p) { return may_be_ground(b, p); };
  for_each_patch(b, own, patching(o), takes_part, [&](const Patch& patch) {
    constexpr int around = margin_cells + 1;  // the rim of empty squares
    const double west = patch.x0 - around * o.building.value, south = patch.y0 - around * o.building.value;
    const Vector corner(west - b.origin.x(), south - b.origin.y(), 0.0);
    // Of points at one place the lowest goes in; those above it within the scatter share its verdict.
    std::vector<Vector> points;
    std::vector<std::uint32_t> point_of_row;
    const auto& rows = patch.rows;
    for (size_t r = 0; r < rows.size(); ++r) {
      if (r == 0 || b.x[rows[r]] != b.x[rows[r - 1]] || b.y[rows[r]] != b.y[rows[r - 1]])
        points.push_back(Vector(b.x[rows[r]], b.y[rows[r]], b.z[rows[r]]) - corner);
      point_of_row.push_back(static_cast<std::uint32_t>(points.size() - 1));
    }
    const std::vector<bool> ground = GroundTin(points, patch_cells + 2 * around, o).densify();
    for (size_t r = 0; r < rows.size(); ++r) {
      const std::uint32_t p = rows[r];
      if (!patch.owns(b.origin.x() + b.x[p], b.origin.y() + b.y[p])) continue;
      const std::uint32_t k = point_of_row[r];
      if (ground[k] && b.z[p] <= points[k].z() + o.scatter.value) verdicts[p] = Verdict::ground;
    }
  });
  return set_ground_classes(b, own, verdicts);
}

}  // namespace swath::filters
