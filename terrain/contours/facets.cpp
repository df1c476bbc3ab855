// SPDX-License-Identifier: GPL-3.0-or-later
// Node units: (u, v) = (x, y) / cell - 1/2, so that cell centres lie at whole numbers. Edges of the triangles are the lines u = k, v = k,
// u + v = k and u - v = k.
#include "terrain/contours/facets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/floor_div.h"

namespace swath::terrain {
namespace {

constexpr std::int64_t page_side = 256;  // nodes
constexpr size_t page_bytes = page_side * page_side * sizeof(float);

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

Facets::Facets(double cell, Load load, size_t bytes)
    : cell_(cell), load_(std::move(load)), most_pages_(std::max<size_t>(1, bytes / page_bytes)) {}

const Facets::Page& Facets::page(std::int64_t pi, std::int64_t pj) {
  const std::uint64_t key = (static_cast<std::uint64_t>(pi) << 32) ^ (static_cast<std::uint64_t>(pj) & 0xffffffffu);
  if (last_ && key == last_key_) return *last_;
  auto at = pages_.find(key);
  if (at == pages_.end()) {
    if (pages_.size() >= most_pages_)
      pages_.erase(
          std::min_element(pages_.begin(), pages_.end(), [](const auto& a, const auto& b) { return a.second.used < b.second.used; }));
    const int side = static_cast<int>(page_side);
    at = pages_.emplace(key, Page{load_({cell_, pi * page_side, pj * page_side, side, side}).height, 0}).first;
  }
  at->second.used = ++clock_;
  last_key_ = key;
  last_ = &at->second;
  return *last_;
}

float Facets::node(std::int64_t i, std::int64_t j) {
  const std::int64_t pi = core::floor_div(i, page_side), pj = core::floor_div(j, page_side);
  return page(pi, pj).height[static_cast<size_t>((j - pj * page_side) * page_side + (i - pi * page_side))];
}

std::array<float, 4> Facets::corners(std::int64_t i, std::int64_t j) {
  const std::int64_t pi = core::floor_div(i, page_side), pj = core::floor_div(j, page_side), ci = i - pi * page_side,
                     cj = j - pj * page_side;
  if (ci + 1 == page_side || cj + 1 == page_side) return {node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)};
  const float* h = page(pi, pj).height.data() + cj * page_side + ci;
  return {h[0], h[1], h[page_side + 1], h[page_side]};
}

double Facets::in_square(std::int64_t i, std::int64_t j, double s, double t) {
  const std::array<float, 4> around = corners(i, j);
  const double h00 = around[0], h10 = around[1], h11 = around[2], h01 = around[3];
  const double middle = 0.25 * ((h00 + h10) + (h11 + h01));
  // r: distance from the triangle's outer edge, along which p runs.
  const auto in = [&](double a, double b, double p, double r) { return a * (1.0 - p - r) + b * (p - r) + 2.0 * r * middle; };
  if (t <= s) return t <= 1.0 - s ? in(h00, h10, s, t) : in(h10, h11, t, 1.0 - s);
  return t <= 1.0 - s ? in(h00, h01, t, s) : in(h01, h11, s, 1.0 - t);
}

double Facets::at_node_units(double u, double v) {
  const std::int64_t i = core::floor_of(u), j = core::floor_of(v);
  const auto fu = static_cast<double>(i), fv = static_cast<double>(j);
  double h = in_square(i, j, u - fu, v - fv);
  if (std::isnan(h) && u == fu) h = in_square(i - 1, j, 1.0, v - fv);
  if (std::isnan(h) && v == fv) h = in_square(i, j - 1, u - fu, 1.0);
  return h;
}

double Facets::at(double x, double y) {
  const Eigen::Vector2d p = node_units({x, y});
  return at_node_units(p.x(), p.y());
}

bool Facets::within(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double height, double tolerance) {
  const Eigen::Vector2d p = node_units(a), d = node_units(b) - p;
  const auto near = [&](double h) { return std::abs(h - height) <= tolerance; };  // false for NaN
  if (!near(at_node_units(p.x(), p.y())) || !near(at_node_units(p.x() + d.x(), p.y() + d.y()))) return false;
  const std::array<double, 4> start{p.x(), p.y(), p.x() + p.y(), p.x() - p.y()}, step{d.x(), d.y(), d.x() + d.y(), d.x() - d.y()};
  for (int family = 0; family < 4; ++family) {
    const double low = std::min(start[family], start[family] + step[family]), high = std::max(start[family], start[family] + step[family]);
    for (double k = static_cast<double>(core::floor_of(low)) + 1.0; k < high; k += 1.0) {
      const double share = (k - start[family]) / step[family];
      const double u = family == 0 ? k : p.x() + share * d.x(), v = family == 1 ? k : p.y() + share * d.y();
      if (!near(at_node_units(u, v))) return false;
      // The segment goes through the squares on both sides, either of which may be void.
      if (family == 0 && std::isnan(at_node_units(k - 0.5, v) + at_node_units(k + 0.5, v))) return false;
      if (family == 1 && std::isnan(at_node_units(u, k - 0.5) + at_node_units(u, k + 0.5))) return false;
    }
  }
  return true;
}

bool Facets::within_inside(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, double height, double tolerance) {
  const std::array<Eigen::Vector2d, 3> corner{node_units(a), node_units(b), node_units(c)};
  const double turn = cross(corner[1] - corner[0], corner[2] - corner[0]) >= 0.0 ? 1.0 : -1.0;
  const auto inside = [&](const Eigen::Vector2d& p) {
    for (size_t k = 0; k < 3; ++k)
      if (turn * cross(corner[(k + 1) % 3] - corner[k], p - corner[k]) < 0.0) return false;
    return true;
  };
  const auto [u0, u1] = std::minmax({corner[0].x(), corner[1].x(), corner[2].x()});
  const auto [v0, v1] = std::minmax({corner[0].y(), corner[1].y(), corner[2].y()});
  for (const double offset : {0.0, 0.5})
    for (double v = std::ceil(v0 - offset) + offset; v <= v1; v += 1.0)
      for (double u = std::ceil(u0 - offset) + offset; u <= u1; u += 1.0)
        if (inside({u, v}) && !(std::abs(at_node_units(u, v) - height) <= tolerance)) return false;
  return true;
}

}  // namespace swath::terrain
