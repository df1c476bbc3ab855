// SPDX-License-Identifier: GPL-3.0-or-later
// An edge is the place t where the density of the roof's returns falls to nothing, smeared by a normal distribution of sigma s (places of
// the returns, width of the beam): density of a return d beyond the surveyed edge ~ Phi((t - d) / s) + e, e for strays. t is the place of
// the largest likelihood, s the same for all edges of a roof. The curvature gives t's sigma: about sqrt(s / (0.9 n)) with n returns per
// metre across the edge. Scan lines along an edge show it between two of them only: their gap, evenly distributed, is added.
//
// A shift of the cloud moves edges on opposite sides the opposite way; the beam's width, which lets a roof begin early on every side, moves
// them all outward. So the edges of a roof give t_k = n_k . shift + wider by least squares.
#include "quality/roof_edges.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/config/units.h"

namespace swath::quality {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double band = 2.0;          // m on both sides of an edge
constexpr double off_corner = 0.5;    // m at both ends of an edge that are left out
constexpr double on_roof = 0.3;       // m from the plane
constexpr double goes_on = 2.5;       // m below the plane: what lies higher beyond the edge is a ridge's other side, a neighbour
constexpr double beyond = 0.5;        // m from an edge: farther out a roof's returns are another one's
constexpr double same_density = 0.2;  // of that over the roof: beyond the edge there is a neighbour
constexpr size_t fewest = 12;         // returns over the roof
constexpr double gaps_within = 1.5;   // m over the roof
constexpr double widest_rim = 0.5;    // m by which all edges may lie farther out or in: more is another roof
constexpr double strays = 0.01;       // of the density over the roof
constexpr double coarse_step = 0.05, step = 0.005;  // m, of the search
constexpr double improbable = 4.0;                  // chi-square per edge to spare, from which sigmas are raised by its root
constexpr std::array<double, 7> smears{0.02, 0.035, 0.06, 0.1, 0.16, 0.25, 0.4};

struct Line {
  Vector2d from, along, out;  ///< unit vectors
  double length;
};

/// The target's edges with outward normals.
std::vector<Line> lines_of(const RoofTarget& t) {
  double area = 0.0;
  const size_t n = t.corners.size();
  for (size_t k = 0; k < n; ++k) {
    const Vector3d &a = t.corners[k], &b = t.corners[(k + 1) % n];
    area += (a.x() - t.corners[0].x()) * (b.y() - t.corners[0].y()) - (b.x() - t.corners[0].x()) * (a.y() - t.corners[0].y());
  }
  const double turn = area >= 0.0 ? 1.0 : -1.0;
  std::vector<Line> out;
  for (size_t k = 0; k < n; ++k) {
    const Vector2d a = t.corners[k].head<2>(), d = t.corners[(k + 1) % n].head<2>() - a;
    const Vector2d along = d.norm() > 0.0 ? Vector2d(d.normalized()) : Vector2d(1.0, 0.0);
    out.push_back({a, along, turn * Vector2d(along.y(), -along.x()), d.norm()});
  }
  return out;
}

/// Height of the plane through the corners, by least squares.
struct Plane {
  Vector3d middle = Vector3d::Zero();
  Vector2d slope = Vector2d::Zero();
  explicit Plane(const std::vector<Vector3d>& corners) {
    for (const Vector3d& c : corners) middle += c / static_cast<double>(corners.size());
    Eigen::Matrix2d a = Eigen::Matrix2d::Zero();
    Vector2d r = Vector2d::Zero();
    for (const Vector3d& c : corners) {
      const Vector3d d = c - middle;
      a += d.head<2>() * d.head<2>().transpose();
      r += d.head<2>() * d.z();
    }
    slope = a.fullPivLu().solve(r);
  }
  double at(const Vector2d& p) const { return middle.z() + slope.dot(p - middle.head<2>()); }
};

double phi(double u) { return std::exp(-0.5 * u * u) / std::sqrt(2.0 * core::pi); }
double big_phi(double u) { return 0.5 * std::erfc(-u / std::sqrt(2.0)); }
/// Of Phi.
double integral(double u) { return u * big_phi(u) + phi(u); }

/// Log likelihood of an edge at t, the density over the roof being free.
double likelihood(const std::vector<double>& out, double t, double s) {
  const double all = s * (integral((t + band) / s) - integral((t - band) / s)) + 2.0 * band * strays;
  double sum = -static_cast<double>(out.size()) * std::log(all);
  for (const double d : out) sum += std::log(big_phi((t - d) / s) + strays);
  return sum;
}

struct EdgeFound {
  double at = 0.0, sigma = 0.0, likelihood = -std::numeric_limits<double>::infinity();
};

/// m, mean gap across the edge between the returns over the roof next to it, by length. Of scan lines along the edge their distance, within
/// which nothing shows where the edge is. `out` ascends.
double gap_before(const std::vector<double>& out, double at) {
  double before = at - gaps_within, sum = 0.0, squares = 0.0;
  const auto add = [&](double d) {
    sum += d - before, squares += (d - before) * (d - before);
    before = d;
  };
  for (const double d : out)
    if (d > before && d < at) add(d);
  add(at);
  return squares / sum;
}

EdgeFound find_edge(const std::vector<double>& out, double s) {
  EdgeFound best;
  const auto search = [&](double from, double to, double by) {
    for (double t = from; t <= to; t += by)
      if (const double l = likelihood(out, t, s); l > best.likelihood) best.at = t, best.likelihood = l;
  };
  search(-0.75 * band, 0.75 * band, coarse_step);
  search(best.at - coarse_step, best.at + coarse_step, step);
  const double h = 0.5 * s;
  const double bend = (2.0 * best.likelihood - likelihood(out, best.at - h, s) - likelihood(out, best.at + h, s)) / (h * h);
  best.sigma = std::hypot(bend > 0.0 ? 1.0 / std::sqrt(bend) : band, gap_before(out, best.at) / std::sqrt(12.0));
  return best;
}

/// Returns on the roof at an edge; nothing where the cloud does not show it.
std::optional<std::vector<double>> shown(const std::vector<const EdgeReturn*>& near) {
  std::vector<double> out;
  size_t over = 0, after = 0;
  for (const EdgeReturn* r : near) {
    const double d = r->out, z = r->above;
    if (d > beyond && z > -goes_on) ++after;
    if (std::abs(z) > on_roof) continue;
    if (d < -beyond) ++over;
    out.push_back(d);
  }
  if (over < fewest || static_cast<double>(after) > same_density * static_cast<double>(over)) return std::nullopt;
  return out;
}

struct Shown {
  Vector2d out;
  std::vector<double> returns;
  EdgeFound edge{};
};

/// All edges with the smear that fits them best.
void find_edges(std::vector<Shown>& edges) {
  double best = -std::numeric_limits<double>::infinity();
  for (const double s : smears) {
    std::vector<EdgeFound> found;
    double sum = 0.0;
    for (const Shown& e : edges) found.push_back(find_edge(e.returns, s)), sum += found.back().likelihood;
    if (sum <= best) continue;
    best = sum;
    for (size_t k = 0; k < edges.size(); ++k) edges[k].edge = found[k];
  }
}

std::optional<RoofShift> shift_of(const std::string& name, std::vector<Shown> edges) {
  if (edges.size() < 3) return std::nullopt;
  find_edges(edges);
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Vector3d r = Vector3d::Zero();
  for (const Shown& e : edges) {
    const Vector3d row(e.out.x(), e.out.y(), 1.0);
    const double weight = 1.0 / (e.edge.sigma * e.edge.sigma);
    a += weight * row * row.transpose();
    r += weight * e.edge.at * row;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> values(a);
  if (!(values.eigenvalues()[0] > 1e-3 * values.eigenvalues()[2])) return std::nullopt;  // edges in one direction, or on one side
  const Eigen::Matrix3d covariance = a.inverse();
  const Vector3d x = covariance * r;
  if (std::abs(x.z()) > widest_rim) return std::nullopt;
  RoofShift out{name, edges.size()};
  double squares = 0.0, chi = 0.0;
  for (const Shown& e : edges) {
    const double v = e.out.dot(x.head<2>()) + x.z() - e.edge.at;
    squares += v * v, chi += v * v / (e.edge.sigma * e.edge.sigma);
    out.returns += e.returns.size();
  }
  const size_t spare = edges.size() - 3;
  // Edges that do not fit together by chance: one edge to spare would say so of every third roof where the sigmas are right.
  const double factor = chi > improbable * static_cast<double>(spare) && spare > 0 ? std::sqrt(chi / static_cast<double>(spare)) : 1.0;
  out.east = x.x(), out.north = x.y(), out.wider = x.z();
  out.sigma_east = factor * std::sqrt(covariance(0, 0)), out.sigma_north = factor * std::sqrt(covariance(1, 1));
  out.misfit = spare > 0 ? std::sqrt(squares / static_cast<double>(edges.size())) : 0.0;
  return out;
}

}  // namespace

std::vector<EdgeReturn> edge_returns(const core::Block& b, std::size_t own, const std::vector<RoofTarget>& targets) {
  std::vector<EdgeReturn> found;
  Vector2d first = Vector2d::Constant(std::numeric_limits<double>::infinity()), last = -first;
  for (size_t p = 0; p < own; ++p) {
    const Vector2d at(b.origin.x() + b.x[p], b.origin.y() + b.y[p]);
    first = first.cwiseMin(at), last = last.cwiseMax(at);
  }
  for (size_t t = 0; t < targets.size(); ++t) {
    const Plane plane(targets[t].corners);
    const std::vector<Line> lines = lines_of(targets[t]);
    Vector2d low = targets[t].corners[0].head<2>(), high = low;
    for (const Vector3d& c : targets[t].corners) low = low.cwiseMin(c.head<2>()), high = high.cwiseMax(c.head<2>());
    low.array() -= band, high.array() += band;
    if ((low.array() > last.array()).any() || (high.array() < first.array()).any()) continue;
    for (size_t p = 0; p < own; ++p) {
      const Vector2d at(b.origin.x() + b.x[p], b.origin.y() + b.y[p]);
      if ((at.array() < low.array()).any() || (at.array() > high.array()).any() || !core::is_usable(b, p)) continue;
      const double above = b.origin.z() + b.z[p] - plane.at(at);
      if (above < -goes_on || above > 3.0) continue;
      for (size_t k = 0; k < lines.size(); ++k) {
        const Vector2d d = at - lines[k].from;
        const double out = d.dot(lines[k].out), along = d.dot(lines[k].along);
        if (std::abs(out) <= band && along > off_corner && along < lines[k].length - off_corner)
          found.push_back({static_cast<std::int32_t>(t), static_cast<std::int32_t>(k), static_cast<float>(out), static_cast<float>(above)});
      }
    }
  }
  return found;
}

std::vector<RoofShift> roof_shifts(const std::vector<RoofTarget>& targets, const std::vector<EdgeReturn>& returns) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<const EdgeReturn*>> by_edge;
  for (const EdgeReturn& r : returns) by_edge[{r.target, r.edge}].push_back(&r);
  std::map<std::int32_t, std::vector<Shown>> by_target;
  for (auto& [key, near] : by_edge) {
    std::sort(near.begin(), near.end(), [](const EdgeReturn* p, const EdgeReturn* q) {
      return std::pair(p->out, p->above) < std::pair(q->out, q->above);  // sums do not depend on tiles
    });
    if (auto out = shown(near))
      by_target[key.first].push_back({lines_of(targets[static_cast<size_t>(key.first)])[static_cast<size_t>(key.second)].out, *out});
  }
  std::vector<RoofShift> shifts;
  for (auto& [target, edges] : by_target)
    if (auto shift = shift_of(targets[static_cast<size_t>(target)].name, std::move(edges))) shifts.push_back(*shift);
  return shifts;
}

RoofPlanimetry planimetry_of(const std::vector<RoofTarget>& targets, const std::vector<RoofShift>& shifts) {
  RoofPlanimetry out;
  out.roofs = shifts.size();
  if (shifts.empty()) return out;
  double targets_square = 0.0;
  for (const auto& [value, sigma, mean, sigma_mean, rmse] : {std::tuple(&RoofShift::east, &RoofShift::sigma_east, &RoofPlanimetry::east,
                                                                        &RoofPlanimetry::sigma_east, &RoofPlanimetry::rmse_east),
                                                             std::tuple(&RoofShift::north, &RoofShift::sigma_north, &RoofPlanimetry::north,
                                                                        &RoofPlanimetry::sigma_north, &RoofPlanimetry::rmse_north)}) {
    double sum = 0.0, weights = 0.0, squares = 0.0;
    for (const RoofShift& s : shifts) {
      const auto of = std::find_if(targets.begin(), targets.end(), [&](const RoofTarget& t) { return t.name == s.name; });
      const double own = of == targets.end() ? 0.0 : of->sigma;
      const double weight = 1.0 / (s.*sigma * s.*sigma + own * own);
      sum += weight * s.*value, weights += weight, squares += s.*value * s.*value;
      targets_square += own * own;
    }
    out.*mean = sum / weights, out.*sigma_mean = 1.0 / std::sqrt(weights);
    out.*rmse = std::sqrt(squares / static_cast<double>(shifts.size()));
  }
  out.rmse = std::hypot(out.rmse_east, out.rmse_north);
  out.with_targets = std::hypot(out.rmse, std::sqrt(targets_square / static_cast<double>(shifts.size())));
  return out;
}

}  // namespace swath::quality
