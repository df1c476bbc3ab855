// SPDX-License-Identifier: GPL-3.0-or-later
// Every pulse near a roof crosses the plane of the roof at a place that its beam gives, whether it met the roof or went on to the ground:
// which of both happened shows where the edge is (quality/edge_places.h). Beams are followed, for a return on the ground lies beside the
// place where its pulse passed the roof, by 3.6 m for an eave of 10 m seen at 20 deg; what lies in the shadow of a roof is not missing.
//
// A shift of the cloud moves edges on opposite sides the opposite way; the beam's width, by which a roof begins early on every side, and
// gutters move them all outward: t_k = n_k . shift + wider, by least squares. The covariance has the pulses' part, edge by edge, and the
// corners' part: an edge lies between two corners and shares each with a neighbour.
//
// Edges are those beyond which the surface falls by 1 m and 1.3 m per metre (ridges, lower roofs close by and trees are none). The top
// `tolerance` of a wall below an edge counts as roof; by how much its pulses come in farther out follows from the beam. Where the wall
// stands back under the eave this is wrong by tolerance tan(angle) at most, 1 cm at 20 deg, half of it in the shift.
#include "quality/roof_edges.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/config/units.h"
#include "core/statistics.h"
#include "quality/edge_places.h"

namespace swath::quality {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double off_corner = 0.5;                            // m at both ends of an edge that are left out
constexpr double inside = 0.5;                                // m from the edges: surely roof
constexpr double near_plane = 0.7;                            // m from the plane: a line's height error is looked for
constexpr size_t fewest_on_plane = 5;                         // returns that show a line's height
constexpr double min_tolerance = 0.03, max_tolerance = 0.15;  // m below the plane that count as roof, two sigmas
constexpr double over_tolerance = 2.5;  // times that above it; higher returns are a tree's or a chimney's, which hide the roof
constexpr size_t fewest_at_edge = 5;    // hits and misses at an edge
constexpr double whole = 0.8;           // share of the pulses over a roof that meet it
constexpr double clear_from = 0.2, clear_to = 1.5, falls = 1.0, falls_per_metre = 1.3, in_the_way = 0.15;
constexpr double widest_sigma = 0.3;    // m of a component that counts as known
constexpr double contradiction = 15.0;  // chi-square of the spare edges: by chance in one of 10 000 roofs

/// A pulse at a target.
struct Pulse {
  const RoofReturn* r;
  double above;            // m above the plane as the line has it
  PlaceAtRoof beam, self;  // where the beam crosses the plane, and where the return lies
};

/// Heights of the lines over the surveyed plane, and how far below it a return still counts as roof.
struct Heights {
  std::map<int, double> of_line;
  double tolerance = min_tolerance;
};

Heights heights_over(const std::vector<RoofSide>& sides, const std::vector<const RoofReturn*>& pulses) {
  std::map<int, std::vector<double>> by_line;
  for (const RoofReturn* r : pulses) {
    const auto above = static_cast<double>(r->above);
    if (std::abs(above) < near_plane && place_at(sides, {static_cast<double>(r->x), static_cast<double>(r->y)}).out < -inside)
      by_line[r->line].push_back(above);
  }
  Heights out;
  std::vector<double> scatter;
  for (const auto& [line, values] : by_line) {
    if (values.size() < fewest_on_plane) continue;
    const double middle = core::median(values);
    out.of_line[line] = middle;
    for (const double v : values) scatter.push_back(std::abs(v - middle));
  }
  out.tolerance = std::clamp(2.0 * core::mad_to_sigma * core::median(scatter, 0.0), min_tolerance, max_tolerance);
  return out;
}

/// An edge that can be used, with its pulses.
struct Shown {
  size_t side;
  std::vector<EdgePulse> pulses;
  EdgePlace place{};
};

/// Is the space beyond an edge that lies at t empty down to well below the roof?
bool is_clear(const std::vector<Pulse>& pulses, size_t side, double t) {
  size_t all = 0, high = 0;
  for (const Pulse& p : pulses) {
    const double beyond = p.self.out - t;
    if (p.self.side != side || p.self.from_end < off_corner || beyond < clear_from || beyond > clear_to) continue;
    ++all;
    high += p.above > -(falls + falls_per_metre * beyond);
  }
  return high < 2 || static_cast<double>(high) <= in_the_way * static_cast<double>(all);
}

std::vector<Shown> shown_edges(const std::vector<RoofSide>& sides, const RoofPlane& plane, const std::vector<Pulse>& pulses,
                               double tolerance) {
  std::vector<Shown> out;
  for (size_t k = 0; k < sides.size(); ++k) {
    Shown s{k, {}};
    size_t hits = 0;
    for (const Pulse& p : pulses) {
      if (p.beam.side != k || p.beam.from_end < off_corner || p.beam.out > roof_band || p.beam.out < -roof_band) continue;
      if (p.above > over_tolerance * tolerance) continue;
      const Vector2d run(static_cast<double>(p.r->run_x), static_cast<double>(p.r->run_y));
      const double wall = tolerance * std::max(0.0, -run.dot(sides[k].out)) / (1.0 + plane.slope.dot(run));
      s.pulses.push_back({p.beam.out, wall, p.above >= -tolerance});
      hits += s.pulses.back().hit;
    }
    if (hits < fewest_at_edge || s.pulses.size() - hits < fewest_at_edge || !is_clear(pulses, k, rough_edge(s.pulses))) continue;
    out.push_back(std::move(s));
  }
  std::vector<std::vector<EdgePulse>> all;
  for (const Shown& s : out) all.push_back(s.pulses);
  const std::vector<EdgePlace> places = edge_places(all);
  for (size_t e = 0; e < out.size(); ++e) out[e].place = places[e];
  std::erase_if(out, [](const Shown& s) { return !s.place.is_shown; });
  return out;
}

/// Covariance of the edges' places: the pulses' and the corners' part.
Eigen::MatrixXd corner_covariance(const std::vector<RoofSide>& sides, const std::vector<Shown>& edges, double sigma) {
  const auto n = static_cast<Eigen::Index>(edges.size());
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index a = 0; a < n; ++a)
    for (Eigen::Index b = 0; b < n; ++b) {
      const size_t i = edges[static_cast<size_t>(a)].side, j = edges[static_cast<size_t>(b)].side, all = sides.size();
      const double shared = i == j ? 2.0 : (i + 1) % all == j || (j + 1) % all == i ? 1.0 : 0.0;
      out(a, b) = 0.25 * shared * sigma * sigma * sides[i].out.dot(sides[j].out);
    }
  return out;
}

/// Shift and width of the edges; its state follows from what they determine.
void adjust(const std::vector<RoofSide>& sides, const std::vector<Shown>& edges, double corner_sigma, RoofShift& out) {
  const auto n = static_cast<Eigen::Index>(edges.size());
  Eigen::MatrixXd design(n, 3);
  Eigen::VectorXd at(n), variance(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Shown& e = edges[static_cast<size_t>(k)];
    design.row(k) << sides[e.side].out.transpose(), 1.0;
    at[k] = e.place.at, variance[k] = e.place.sigma * e.place.sigma;
    out.pulses += e.pulses.size();
  }
  out.edges = edges.size();
  const Eigen::MatrixXd of_corners = corner_covariance(sides, edges, corner_sigma);
  const Eigen::MatrixXd weight = (of_corners + Eigen::MatrixXd(variance.asDiagonal())).inverse();
  const Eigen::Matrix3d normal = design.transpose() * weight * design;
  // The shift's part, the width being free.
  const Vector2d mixed = normal.block<2, 1>(0, 2);
  const Eigen::Matrix2d information = normal.topLeftCorner<2, 2>() - mixed * mixed.transpose() / normal(2, 2);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> parts(information);
  const double least = 1.0 / (widest_sigma * widest_sigma);
  if (!(parts.eigenvalues()[1] > least)) return;
  const bool both = parts.eigenvalues()[0] > least;
  Eigen::MatrixXd inverse;  // 3 x n: shift and width of the places
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(Eigen::Matrix3d(normal / normal.trace()));
  inverse = solver.solve(Eigen::MatrixXd(design.transpose() * weight / normal.trace()));
  const Vector3d x = inverse * at;
  const Eigen::VectorXd left = at - design * x;
  const double spare = static_cast<double>(n) - (both ? 3.0 : 2.0);
  out.shift = x.head<2>(), out.wider = x.z();
  out.misfit = spare > 0.0 ? std::sqrt(left.squaredNorm() / static_cast<double>(n)) : 0.0;
  const Vector2d best = parts.eigenvectors().col(1);
  const Eigen::Matrix3d of_target = inverse * of_corners * inverse.transpose();
  if (both) {
    out.information = information;
    out.target_sigma = std::sqrt(0.5 * of_target.topLeftCorner<2, 2>().trace());
  } else {
    out.shift = best * best.dot(out.shift);
    out.information = parts.eigenvalues()[1] * best * best.transpose();
    out.target_sigma = std::sqrt(best.dot(of_target.topLeftCorner<2, 2>() * best));
  }
  const double chi = left.dot(weight * left);
  out.state = std::abs(out.wider) > widest_rim || (spare > 0.0 && chi > contradiction) ? RoofState::disagrees
              : both                                                                   ? RoofState::both
                                                                                       : RoofState::one;
}

/// Beams that run otherwise than they seem to move the misses by that on the way down to what lies below, and the edges by half of it.
void add_beams(double run_sigma, const std::vector<Pulse>& pulses, RoofShift& out) {
  std::vector<double> depths;
  for (const Pulse& p : pulses)
    if (std::abs(p.beam.out) < roof_band && p.above < -falls) depths.push_back(-p.above);
  const double sigma = 0.5 * run_sigma * core::median(depths, 0.0);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> parts(out.information);
  out.information.setZero();
  for (int k = out.state == RoofState::both ? 0 : 1; k < 2; ++k) {
    const Vector2d v = parts.eigenvectors().col(k);
    out.information += v * v.transpose() / (1.0 / parts.eigenvalues()[k] + sigma * sigma);
  }
}

RoofShift shift_of(const RoofTarget& target, const std::vector<const RoofReturn*>& returns, double run_sigma) {
  RoofShift out;
  out.name = target.name;
  for (const Vector3d& c : target.corners) out.middle += c.head<2>() / static_cast<double>(target.corners.size());
  const std::vector<RoofSide> sides = sides_of(target);
  const RoofPlane plane(target);
  const Heights heights = heights_over(sides, returns);
  std::vector<Pulse> pulses;
  size_t over = 0, met = 0;
  for (const RoofReturn* r : returns) {
    const auto line = heights.of_line.find(r->line);
    if (line == heights.of_line.end()) continue;
    const double above = static_cast<double>(r->above) - line->second;
    pulses.push_back({r, above, place_at(sides, crossing_of(*r, plane, line->second)),
                      place_at(sides, {static_cast<double>(r->x), static_cast<double>(r->y)})});
    if (pulses.back().beam.out < -2.0 * inside) ++over, met += above >= -heights.tolerance;
  }
  if (static_cast<double>(met) < whole * static_cast<double>(over) || met == 0) {
    out.state = RoofState::not_there;
    return out;
  }
  const std::vector<Shown> edges = shown_edges(sides, plane, pulses, heights.tolerance);
  if (edges.size() > 1) adjust(sides, edges, target.sigma, out);
  if (out.is_known() && run_sigma > 0.0) add_beams(run_sigma, pulses, out);
  return out;
}

}  // namespace

Vector2d best_direction(const Eigen::Matrix2d& information) {
  const Vector2d best = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(information).eigenvectors().col(1);
  return best.x() < 0.0 || (best.x() == 0.0 && best.y() < 0.0) ? Vector2d(-best) : best;
}
double azimuth_of(const Vector2d& direction) { return core::to_degrees(std::atan2(direction.x(), direction.y())); }
std::optional<double> RoofShift::of_axis(int axis) const { return state == RoofState::both ? std::optional(shift[axis]) : std::nullopt; }
std::optional<double> RoofShift::sigma(int axis) const {
  return state == RoofState::both ? std::optional(std::sqrt(information.inverse()(axis, axis))) : std::nullopt;
}

std::vector<RoofShift> roof_shifts(const std::vector<RoofTarget>& targets, const std::vector<RoofReturn>& returns,
                                   const std::vector<double>& run_sigmas) {
  const std::vector<RoofReturn> pulses = first_of_pulses(returns);
  std::vector<std::vector<const RoofReturn*>> by_target(targets.size());
  for (const RoofReturn& r : pulses) by_target[static_cast<size_t>(r.target)].push_back(&r);
  std::vector<RoofShift> out;
  for (size_t t = 0; t < targets.size(); ++t) out.push_back(shift_of(targets[t], by_target[t], run_sigmas.empty() ? 0.0 : run_sigmas[t]));
  return out;
}

}  // namespace swath::quality
