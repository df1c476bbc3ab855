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
// - Farther than a quarter of a square from the squares whose points are judged, the lowest point of each cell of a 20th of a square takes
//   part alone (+0.4; of a simulated survey of 9 points per square metre 0.25 % of the returns change their class). It takes a third of the
//   time.
// - Beyond the outermost seeds the TIN is held by made vertices, at the centres of the empty squares around, on the plane through the
//   ground points near by; the plane is renewed in every round. The paper does not say what is done there.
#include "filters/ground/ground_ptd.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/grid.h"
#include "filters/ground/patch_points.h"

namespace swath::filters {
namespace {

constexpr int patch_cells = 4;                                   // squares of the seeds
constexpr int margin_cells = 2;                                  // a facet of the first TIN is seldom longer
constexpr double whole_margin = 0.25;                            // squares around a patch from which every point is taken
constexpr int thinned = 20;                                      // cells along a square that leave their lowest point behind those
const double break_slope = std::tan(core::degrees(30.0).value);  // rise / run of a facet that hangs over a break

struct VertexInfo {
  double z = 0;
  bool made = false;  // not a measured point
};
using Vector = Eigen::Vector3d;

/// A point that is not yet ground.
struct Candidate {
  Vector at;
  std::uint32_t point;
};
struct FaceInfo {
  std::vector<Candidate> points;  // that lie in the face, side by side: most of the time goes into judging them
  bool fresh = true;              // points not yet judged against it
};
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<VertexInfo, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<FaceInfo, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>>;
using Face = Delaunay::Face_handle;
using Vertex = Delaunay::Vertex_handle;

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
  double sine = 0;  // of the angle
  double away = 0;  // m to the nearest vertex
  std::uint32_t point = 0;
  Face face;

  bool operator<(const Fit& o) const {
    if (sine != o.sine) return sine < o.sine;
    return away != o.away ? away > o.away : point < o.point;
  }
};

/// A face in space, as its points are judged by it.
struct Facet {
  std::array<Vector, 3> corner;
  std::array<bool, 3> made;
  Vector normal;  // unit, upwards
  bool steep;
  int highest = 0;

  explicit Facet(Face f) {
    for (int i = 0; i < 3; ++i) corner[i] = place(f->vertex(i)), made[i] = f->vertex(i)->info().made;
    const Vector n = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    normal = n.normalized();
    steep = n.head<2>().norm() > break_slope * std::abs(n.z());
    for (int i = 1; i < 3; ++i)
      if (corner[i].z() > corner[highest].z()) highest = i;
  }
  double height_over(const Vector& p) const { return normal.dot(p - corner[0]); }
  bool has_made_corner() const { return made[0] || made[1] || made[2]; }
  bool highest_is_nearest(const Vector& p) const {
    const double d = (corner[highest] - p).head<2>().squaredNorm();
    return std::none_of(corner.begin(), corner.end(), [&](const Vector& c) { return (c - p).head<2>().squaredNorm() < d; });
  }
};

/// The TIN of one patch. Points are known by their index in `points`.
class GroundTin {
 public:
  /// `points` relative to the south-west corner of the squares, no two at one (x, y), in lexicographic order; `cells` squares of the seeds
  /// in each direction, the outermost of them empty.
  GroundTin(const std::vector<Vector>& points, int cells, const PtdOptions& o)
      : points_(points), cells_(cells), o_(o), most_sine_(std::sin(o.angle.value)) {
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
      near->info().points.push_back({points_[k], k});
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
      if (f->info().points.empty()) continue;
      const Facet facet(f);
      std::optional<Fit> best;
      for (const Candidate& c : f->info().points) {
        const auto fit = judge(f, facet, c);
        if (fit && (!best || *fit < *best) && !ground_[c.point]) best = fit;
      }
      if (best) out.push_back(*best);
    }
    std::sort(out.begin(), out.end(), [](const Fit& a, const Fit& b) { return a.point < b.point; });
    return out;
  }

  std::optional<Fit> judge(Face f, const Facet& facet, const Candidate& c) {
    const Vector& p = c.at;
    const double height = facet.height_over(p);
    auto fit = fit_to(facet, p, height);
    if (!fit && o_.mirror && facet.steep && height > 0.0 && !facet.made[facet.highest] && facet.highest_is_nearest(p)) {
      const Vector mirrored = 2.0 * facet.corner[facet.highest] - p;
      const Face there = tin_.locate({mirrored.x(), mirrored.y()}, f);
      if (!tin_.is_infinite(there)) {
        const Facet beyond(there);
        if (!beyond.has_made_corner() && !beyond.steep) fit = fit_to(beyond, mirrored, beyond.height_over(mirrored));
      }
    }
    if (fit) fit->point = c.point, fit->face = f;
    return fit;
  }

  /// Distance from the facet and angles at its vertices within the limits, or nothing.
  std::optional<Fit> fit_to(const Facet& f, const Vector& p, double height) const {
    const double distance = std::abs(height);
    if (!(distance <= o_.distance.value)) return std::nullopt;
    double away = -1.0, made_away = -1.0;
    for (int i = 0; i < 3; ++i) {
      const double d = (f.corner[i] - p).squaredNorm();
      double& least = f.made[i] ? made_away : away;
      if (least < 0 || d < least) least = d;
    }
    away = std::sqrt(away < 0 ? made_away : away);
    const double excess = std::max(distance - o_.scatter.value, 0.0);
    const double sine = excess < away ? excess / away : 1.0;
    if (!(sine <= most_sine_)) return std::nullopt;
    return Fit{sine, away, 0, {}};
  }

  /// Makes point k a vertex and gives the points of the faces that go to the faces that come.
  void insert(std::uint32_t k, Face near) {
    const Kernel::Point_2 p(points_[k].x(), points_[k].y());
    Delaunay::Locate_type type;
    int index = 0;
    const Face at = tin_.locate(p, type, index, near);
    std::vector<Face> gone;
    if (type != Delaunay::VERTEX) tin_.get_conflicts(p, std::back_inserter(gone), at);
    homeless_.clear();
    for (const Face f : gone) {
      homeless_.insert(homeless_.end(), f->info().points.begin(), f->info().points.end());
      f->info().points.clear();
    }
    ground_[k] = true;
    if (type == Delaunay::VERTEX) return;  // a made vertex stands there
    const Vertex v = add_vertex(points_[k], false, at);
    star_.clear();
    auto f = tin_.incident_faces(v);
    const auto first = f;
    do {
      f->info().points.clear();
      f->info().fresh = true;
      star_.push_back({f, f->vertex(Delaunay::ccw(f->index(v)))->point()});
    } while (++f != first);
    for (const Candidate& c : homeless_)
      if (c.point != k) face_around(v->point(), c.at)->info().points.push_back(c);
  }

  /// A face at the new vertex, and the end of its edge from there on the right.
  struct Spoke {
    Face face;
    Kernel::Point_2 end;
  };

  /// Of the faces at the new vertex, in their order around it, the one that holds the point.
  Face face_around(const Kernel::Point_2& v, const Vector& p) const {
    bool is_left = !is_right_of(v, star_.front().end, p);
    for (size_t i = 0; i < star_.size(); ++i) {
      const bool right_of_next = is_right_of(v, star_[i + 1 < star_.size() ? i + 1 : 0].end, p);
      if (is_left && right_of_next) return star_[i].face;
      is_left = !right_of_next;
    }
    return star_.front().face;
  }

  /// Of the line from v to w. Exact.
  static bool is_right_of(const Kernel::Point_2& v, const Kernel::Point_2& w, const Vector& p) {
    constexpr double rounding = 8.0 * std::numeric_limits<double>::epsilon();
    const double a = (w.x() - v.x()) * (p.y() - v.y()), b = (w.y() - v.y()) * (p.x() - v.x());
    if (std::abs(a - b) > rounding * (std::abs(a) + std::abs(b))) return a < b;
    return CGAL::orientation(v, w, Kernel::Point_2(p.x(), p.y())) == CGAL::RIGHT_TURN;
  }

  const std::vector<Vector>& points_;
  const int cells_;
  const PtdOptions& o_;
  const double most_sine_;
  Delaunay tin_;
  std::vector<bool> ground_;
  std::vector<PlaneSums> sums_;  // of the ground points, per square
  std::vector<Vertex> rim_;      // made vertices
  std::vector<Candidate> homeless_;
  std::vector<Spoke> star_;
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
    constexpr int cells = patch_cells + 2 * around;
    const PatchPoints taken(b, patch, corner, {whole_margin * o.building.value, o.building.value / thinned, cells * thinned});
    const std::vector<bool> ground = GroundTin(taken.points, cells, o).densify();
    const auto& rows = patch.rows;
    for (size_t r = 0; r < rows.size(); ++r) {
      const std::uint32_t p = rows[r];
      if (!patch.owns(b.origin.x() + b.x[p], b.origin.y() + b.y[p])) continue;
      // Points above the lowest at their place share its verdict within the scatter.
      const std::uint32_t k = taken.point_of_row[r];
      if (ground[k] && b.z[p] <= taken.points[k].z() + o.scatter.value) verdicts[p] = Verdict::ground;
    }
  });
  return set_ground_classes(b, own, verdicts);
}

}  // namespace swath::filters
