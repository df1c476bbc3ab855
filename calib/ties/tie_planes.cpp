// SPDX-License-Identifier: GPL-3.0-or-later
// Steps: moments of cells (plane_cells), facets grown over them (facets), returns near the facets (tie_returns), and here the judgement of
// each plane from its own returns: RANSAC (Fischler & Bolles 1981; PCL) line by line, so that lines that miss one another do not spoil it;
// edges; agreement between the lines.
#include "calib/ties/tie_planes.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/ransac.h>
#include <pcl/sample_consensus/sac_model_perpendicular_plane.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <tuple>

#include "calib/ties/facet_choice.h"
#include "calib/ties/plane_edges.h"
#include "calib/ties/tie_returns.h"
#include "core/error.h"
#include "core/statistics.h"
#include "filters/pcl_messages.h"

namespace swath::calib {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double ransac_distance = 2.5;  // in roughnesses
constexpr double found_share = 0.6;      // of a look's returns near a facet that must lie on its plane
constexpr double target_share = 0.3;     // the same for targets, which are looked for over metres of height
constexpr double facet_tilt = 0.1;       // rad, between a facet and the plane of a look's returns
constexpr double target_tilt = 0.06;     // rad, between a target as surveyed and as seen
constexpr double ground_tilt = 0.35;     // rad, of the ground about a lone point
constexpr double point_radius = 3.0;     // m, of the ground about a lone point
constexpr double tilt_slack = 0.01;      // rad, between looks: boresight and attitude
constexpr double coarse_mismatch = 0.5;  // m: margins do not grow beyond it
constexpr int ransac_iterations = 200;

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

// Returns of one look: rows of the region's list.
struct Look {
  std::uint32_t line = 0;
  std::vector<std::uint32_t> rows;
  PlaneShape shape;  // of the rows' places
  Vector3d mean = Vector3d::Zero();
};

std::vector<Look> looks_of(std::vector<NearReturn>& all) {
  std::sort(all.begin(), all.end(),
            [](const NearReturn& a, const NearReturn& b) { return std::tie(a.line, a.time, a.draw) < std::tie(b.line, b.time, b.draw); });
  std::vector<Look> out;
  for (std::uint32_t r = 0; r < all.size(); ++r) {
    if (r == 0 || all[r].line != all[r - 1].line || all[r].time - all[r - 1].time > new_look) {
      out.emplace_back();
      out.back().line = all[r].line;
    }
    out.back().rows.push_back(r);
  }
  return out;
}

void refit(Look& l, const std::vector<NearReturn>& all) {
  Moments<double> m;
  for (const std::uint32_t r : l.rows) {
    const Vector3d p = all[r].place.cast<double>();
    m.add(p.x(), p.y(), p.z());
  }
  l.shape = shape_of(m.scatter(), m.n - 1.0);
  l.mean = m.mean();
}
void keep_near(Look& l, const std::vector<NearReturn>& all, const std::vector<std::uint32_t>& from, double distance) {
  const Look fitted = l;
  l.rows.clear();
  for (const std::uint32_t r : from)
    if (std::abs(fitted.shape.normal.dot(all[r].place.cast<double>() - fitted.mean)) <= distance) l.rows.push_back(r);
}

// What a plane must satisfy.
struct Demands {
  double tilt = facet_tilt, share = found_share, tolerance = 0.08;
  size_t fewest = 12, looks = 2;
};

// The returns on the dominant plane of a look, or why there is none.
std::string take_plane(Look& l, const std::vector<NearReturn>& all, const Vector3d& normal, const Demands& d) {
  if (l.rows.size() < d.fewest) return "too few returns of a line";
  const auto cloud = std::make_shared<Cloud>();
  for (const std::uint32_t r : l.rows) cloud->emplace_back(all[r].place.x(), all[r].place.y(), all[r].place.z());
  const auto model = std::make_shared<pcl::SampleConsensusModelPerpendicularPlane<pcl::PointXYZ>>(cloud);  // its own fixed seed
  model->setAxis(normal.cast<float>());
  model->setEpsAngle(d.tilt);
  pcl::RandomSampleConsensus<pcl::PointXYZ> ransac(model, ransac_distance * d.tolerance);
  ransac.setMaxIterations(ransac_iterations);
  if (!ransac.computeModel()) return "no plane in the returns of a line";
  pcl::Indices inliers;
  ransac.getInliers(inliers);
  const std::vector<std::uint32_t> near = l.rows;
  l.rows.clear();
  for (const auto k : inliers) l.rows.push_back(near[static_cast<size_t>(k)]);
  for (int again = 0; again < 3; ++again) {
    if (l.rows.size() < d.fewest) return "too few returns of a line";
    refit(l, all);
    keep_near(l, all, near, std::clamp(3.0 * l.shape.rms, 0.5 * d.tolerance, ransac_distance * d.tolerance));
  }
  if (l.rows.size() < d.fewest) return "too few returns of a line";
  refit(l, all);
  if (static_cast<double>(l.rows.size()) < d.share * static_cast<double>(near.size())) return "other things in the way";
  if (l.shape.rms > d.tolerance) return "rough";
  return "";
}

struct Judged {
  TiePlane plane;
  std::vector<Look> looks;
};

class Judge {
 public:
  Judge(const TiePlaneOptions& o, LocalPoints& points) : o_(o), points_(points) {}

  /// The plane of a region's returns with the looks that take part, or why there is none.
  std::string judge(const PlaneRegion& region, std::vector<NearReturn>& all, const Demands& d, Judged& out) const {
    std::vector<Look> looks = looks_of(all);
    std::string why = "seen by one line alone";
    std::erase_if(looks, [&](Look& l) {
      std::string fault = take_plane(l, all, region.normal, d);
      const bool is_bad = !fault.empty();
      if (is_bad) why = std::move(fault);
      return is_bad;
    });
    if (looks.size() < d.looks) return why;
    keep_agreeing(looks, d);
    if (looks.size() < d.looks) return "lines do not agree";
    const Vector3d normal = pooled_normal(looks, all);
    if (region.outline.empty()) drop_edges(looks, all, normal);
    std::erase_if(looks, [&](const Look& l) { return l.rows.size() < d.fewest; });
    if (looks.size() < d.looks) return "too few returns of a line";
    for (Look& l : looks) {
      thin(l, all);
      refit(l, all);
    }
    // A look along a single scan line does not hold its plane.
    std::erase_if(looks, [&](const Look& l) { return l.shape.narrow < 0.3 * o_.extent->value; });
    if (looks.size() < d.looks) return "returns along one scan line";
    return assemble(region, all, std::move(looks), out);
  }

 private:
  // Takes out looks whose plane is another one.
  void keep_agreeing(std::vector<Look>& looks, const Demands& d) const {
    if (looks.size() < 2) return;
    const Look* largest = &looks[0];
    for (const Look& l : looks)
      if (l.rows.size() > largest->rows.size()) largest = &l;
    const Vector3d normal = largest->shape.normal, at = largest->mean;
    std::vector<double> offsets;
    for (const Look& l : looks) offsets.push_back(normal.dot(l.mean - at));
    const double middle = core::median(offsets);
    const double apart = 3.0 * o_.mismatch.value + 3.0 * d.tolerance;
    std::erase_if(looks, [&](const Look& l) {
      const double tilt = std::acos(std::min(std::abs(l.shape.normal.dot(normal)), 1.0));
      const auto sigma = [](const Look& x) {
        return x.shape.rms / (std::sqrt(static_cast<double>(x.rows.size())) * std::max(x.shape.narrow, 0.1));
      };
      const double allowed = 3.0 * (sigma(l) + sigma(*largest)) + tilt_slack + 0.5 * o_.mismatch.value / std::max(l.shape.narrow, 1.0);
      return std::abs(normal.dot(l.mean - at) - middle) > apart || tilt > allowed;
    });
  }

  static Vector3d pooled_normal(const std::vector<Look>& looks, const std::vector<NearReturn>& all) {
    Matrix3d scatter = Matrix3d::Zero();
    for (const Look& l : looks)
      for (const std::uint32_t r : l.rows) {
        const Vector3d p = all[r].place.cast<double>() - l.mean;
        scatter += p * p.transpose();
      }
    return shape_of(scatter, 1.0).normal;
  }

  void drop_edges(std::vector<Look>& looks, const std::vector<NearReturn>& all, const Vector3d& normal) const {
    const auto axes = plane_axes(normal);
    const auto flat = [&](std::uint32_t r) {
      const Vector3d p = all[r].place.cast<double>();
      return Vector2d(axes[0].dot(p), axes[1].dot(p));
    };
    std::vector<Vector2d> at;
    Vector2d low = Vector2d::Constant(1e9), high = -low;
    for (const Look& l : looks)
      for (const std::uint32_t r : l.rows) {
        at.push_back(flat(r));
        low = low.cwiseMin(at.back()), high = high.cwiseMax(at.back());
      }
    constexpr double per_cell = 4.0, smallest = 0.4;
    const double cell = std::max(smallest, std::sqrt(per_cell * (high - low).prod() / static_cast<double>(at.size())));
    const Occupied occupied(at, cell);
    const double margin = o_.margin->value + std::min(o_.mismatch.value, coarse_mismatch);
    for (Look& l : looks) std::erase_if(l.rows, [&](std::uint32_t r) { return !occupied.surrounds(flat(r), margin); });
  }

  // The lowest draws, in the order of time.
  void thin(Look& l, const std::vector<NearReturn>& all) const {
    const auto most = static_cast<size_t>(o_.returns);
    if (l.rows.size() <= most) return;
    std::nth_element(l.rows.begin(), l.rows.begin() + static_cast<long>(most), l.rows.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return std::tie(all[a].draw, a) < std::tie(all[b].draw, b); });
    l.rows.resize(most);
    std::sort(l.rows.begin(), l.rows.end());
  }

  std::string assemble(const PlaneRegion& region, const std::vector<NearReturn>& all, std::vector<Look> looks, Judged& out) const {
    Vector3d normal = pooled_normal(looks, all);
    // Which side each look sees: a thin wall has two.
    int front = 0, back = 0;
    for (const Look& l : looks) {
      const auto place = points_.place_at(all[l.rows[l.rows.size() / 2]].time);
      if (!place) continue;
      (normal.dot(region.centre + l.mean - place->scanner) < 0.0 ? front : back) += 1;
    }
    if (front > 0 && back > 0) return "seen from both sides";
    if (back > 0) normal = -normal;
    const auto axes = plane_axes(normal);
    Vector3d sum = Vector3d::Zero();
    double n = 0.0, squares = 0.0, freedom = 0.0;
    for (const Look& l : looks) {
      const auto m = static_cast<double>(l.rows.size());
      sum += m * l.mean, n += m;
      squares += (m - 3.0) * l.shape.rms * l.shape.rms, freedom += m - 3.0;
    }
    const Vector3d mean = sum / n;
    Vector2d spread2 = Vector2d::Zero();
    for (const Look& l : looks)
      for (const std::uint32_t r : l.rows) {
        const Vector3d p = all[r].place.cast<double>() - mean;
        spread2 += Vector2d(axes[0].dot(p), axes[1].dot(p)).cwiseAbs2() / n;
      }
    TiePlane& plane = out.plane;
    plane.centre = region.centre + mean;
    plane.normal = normal;
    plane.half = (3.0 * spread2).cwiseSqrt();  // of an even spread
    plane.roughness = std::sqrt(squares / freedom);
    if (plane.half.minCoeff() < o_.extent->value) return "too small";
    out.looks = std::move(looks);
    return "";
  }

  const TiePlaneOptions& o_;
  LocalPoints& points_;
};

FacetOptions facet_options(const TiePlaneOptions& o) {
  FacetOptions f;
  f.piece = o.piece->value, f.roughness = o.roughness->value, f.extent = o.extent->value, f.mismatch = o.mismatch.value;
  f.returns = static_cast<std::uint32_t>(o.fewest), f.most = static_cast<size_t>(*o.planes), f.thin_walls = o.thin_walls;
  return f;
}

PlaneRegion region_of(const SurveyedTarget& t, const TiePlaneOptions& o, double density) {
  PlaneRegion r;
  r.centre = t.centre, r.normal = t.normal;
  r.reach = o.target_search.value;
  const auto axes = plane_axes(r.normal);
  if (t.is_point) {
    for (int k = 0; k < 16; ++k) r.outline.push_back(point_radius * Vector2d(std::cos(k * core::pi / 8), std::sin(k * core::pi / 8)));
  } else {
    r.margin = o.margin->value + std::min(o.mismatch.value, coarse_mismatch);
    for (const Vector3d& p : t.corners) r.outline.emplace_back(axes[0].dot(p - r.centre), axes[1].dot(p - r.centre));
  }
  double area = 0.0;
  for (size_t k = 0; k < r.outline.size(); ++k) {
    const Vector2d &a = r.outline[k], &b = r.outline[(k + 1) % r.outline.size()];
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  // Twice the returns, for other things lie within the search too.
  r.wanted = static_cast<std::uint32_t>(2 * o.returns);
  r.looks.push_back({0, 0.0, 0.0, static_cast<std::uint32_t>(std::abs(area) * density) + 1});
  return r;
}

void append(TieSet& set, Judged& j, const std::vector<NearReturn>& all) {
  const auto plane = static_cast<std::uint32_t>(set.planes.size());
  set.planes.push_back(std::move(j.plane));
  for (const Look& l : j.looks) {
    TieGroup g{plane, l.line, static_cast<std::uint32_t>(set.returns.size()), 0};
    for (const std::uint32_t r : l.rows) {
      set.returns.time.push_back(all[r].time);
      set.returns.angle.push_back(all[r].angle);
      set.returns.forward.push_back(all[r].forward);
      set.returns.range.push_back(all[r].range);
    }
    g.end = static_cast<std::uint32_t>(set.returns.size());
    set.groups.push_back(g);
  }
}

PlaneRegion region_of(const Facet& f, const TiePlaneOptions& o) {
  PlaneRegion r;
  r.centre = f.centre, r.normal = f.normal, r.cells = f.cells, r.looks = f.looks;
  r.reach = 3.0 * o.mismatch.value + ransac_distance * o.roughness->value;
  r.wanted = static_cast<std::uint32_t>(o.returns);
  return r;
}

bool lies_on(const Facet& f, const PlaneRegion& r) {
  const auto axes = plane_axes(r.normal);
  const Vector3d away = f.centre - r.centre;
  return std::abs(r.normal.dot(away)) < r.reach && is_inside(r.outline, {axes[0].dot(away), axes[1].dot(away)}, 0.0);
}

/// What the set holds, and why it is empty where it is.
void count_ties(const TieSet& set, core::Tally& tally) {
  for (const TiePlane& p : set.planes) tally.count("planes: " + std::string(name_of(p.kind)));
  std::set<std::uint32_t> tied;
  for (const TieGroup& g : set.groups) tied.insert(g.line);
  for (std::uint32_t l = 0; l < set.lines.size(); ++l)
    if (!tied.contains(l)) tally.count("lines without ties", "line " + std::to_string(set.lines[l].id));
  if (!set.planes.empty()) return;
  if (tally.of("cells") > 0 && tally.of("cells refused: one line") + tally.of("cells refused: not plane") == tally.of("cells"))
    tally.count("no ties: no place that two lines have seen is plane");
  else
    tally.count("no ties: no plane is good enough");
}

}  // namespace

void refuse_without_planes(const core::Tally& tally, const std::string& what_else, const std::string& where, const std::string& hint) {
  std::string listed;
  const core::Value counts = tally.value();
  for (const auto& [what, one] : counts.members())
    listed += (listed.empty() ? "" : "; ") + what + ": " + std::to_string(one.find("count")->as_int());
  throw core::Error("no plane was found that two lines have seen" + what_else + (listed.empty() ? "" : " (" + listed + ")"), where,
                    "lines must overlap over level or sloping planes of some metres" + hint);
}

TieSet find_tie_planes(const ShotStream& stream, const core::Scanner& scanner, const core::Calibration& calibration,
                       const trajectory::Trajectory& trajectory, const trajectory::LocalFrame& frame,
                       const std::vector<SurveyedTarget>& targets, const TiePlaneOptions& given, core::Tally& tally) {
  filters::silence_pcl();
  const TiePlaneOptions o = sized(given, {});
  TieSet set;
  set.frame = frame;
  LocalPoints points(scanner, calibration, trajectory, frame);
  std::vector<Facet> facets;
  std::vector<PlaneRegion> regions;
  double side = 0.0;
  {
    const PlaneCells cells =
        plane_cells(stream, points, o.cell ? std::optional(o.cell->value) : std::nullopt, o.thin_walls ? 1 : usual_fewest);
    set.lines = cells.lines;
    side = cells.side;
    if (cells.returns == 0) {
      tally.count("no return has a place on the trajectory");
      return set;
    }
    facets = choose_facets(find_facets(cells, facet_options(o), tally), scanner_of(points), {o.per_second, o.returns}, tally);
    for (const SurveyedTarget& t : targets) regions.push_back(region_of(t, o, cells.density));
  }
  std::erase_if(facets, [&](const Facet& f) {
    return std::any_of(regions.begin(), regions.end(), [&](const PlaneRegion& target) { return lies_on(f, target); });
  });
  for (const Facet& f : facets) regions.push_back(region_of(f, o));
  std::vector<std::vector<NearReturn>> near;
  if (!regions.empty()) near = collect_returns(stream, points, regions, side, set.lines);

  const Judge judge(o, points);
  for (size_t k = 0; k < regions.size(); ++k) {
    const bool is_target = k < targets.size();
    Judged j;
    Demands d;
    d.fewest = static_cast<size_t>(o.fewest), d.tolerance = o.roughness->value;
    if (is_target) {
      j.plane.kind = TieKind::target;
      j.plane.name = targets[k].name;
      j.plane.control = targets[k].control;
      d.looks = 1;
      d.share = target_share;
      d.tilt = targets[k].is_point ? ground_tilt : target_tilt;
    } else {
      j.plane.kind = facets[k - targets.size()].kind;
    }
    const std::string why = judge.judge(regions[k], near[k], d, j);
    // Only now is known which way the ground about a lone point slopes.
    if (is_target && targets[k].is_point && why.empty())
      for (PlaneControl& c : j.plane.control) c.sigma = sigma_along(j.plane.normal, targets[k].sigma_h, c.sigma);
    if (!why.empty())
      is_target ? tally.count("targets not found", targets[k].name + ": " + why) : tally.count("planes refused: " + why);
    else
      append(set, j, near[k]);
    std::vector<NearReturn>().swap(near[k]);
  }
  count_ties(set, tally);
  return set;
}

}  // namespace swath::calib
