// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace swath::terrain {
namespace {

// Widths of the first border and of a cell, in mean distances between points: a triangle's disc rarely is wider.
constexpr double border_distances = 8.0;
// Share of a circle's radius by which its rounded centre and radius may be wrong: see tin.cpp; a thousand times the bound there.
constexpr double rounding = 1e-6;
constexpr double most_cells = 1024.0;  // along a side

bool holds(const Rectangle& r, double x, double y) { return x >= r.west && x <= r.east && y >= r.south && y <= r.north; }

/// What of `r` lies to the left of the line from a to b, as a box around it. `slack`: of the cross product.
Rectangle left_of(const Place& a, const Place& b, const Rectangle& r, double slack) {
  constexpr double far = std::numeric_limits<double>::infinity();
  Rectangle out{far, far, -far, -far};
  const std::array<Place, 4> corner{{{r.west, r.south}, {r.east, r.south}, {r.east, r.north}, {r.west, r.north}}};
  const auto left = [&](const Place& p) { return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x); };
  const auto add = [&](double x, double y) {
    out = {std::min(out.west, x), std::min(out.south, y), std::max(out.east, x), std::max(out.north, y)};
  };
  for (size_t k = 0; k < 4; ++k) {
    const Place &p = corner[k], &q = corner[(k + 1) % 4];
    const double lp = left(p), lq = left(q);
    if (lp >= -slack) add(p.x, p.y);
    if ((lp < 0.0) != (lq < 0.0)) add(p.x + (q.x - p.x) * lp / (lp - lq), p.y + (q.y - p.y) * lp / (lp - lq));
  }
  return out;
}

}  // namespace

Surroundings::Surroundings(const core::Block& block, const std::vector<std::uint32_t>& rows, const Rectangle& where, double max_radius)
    : block_(block), rows_(rows), where_(where), near_(where) {
  if (rows.empty() || !std::isfinite(where.west + where.east + where.south + where.north)) return;
  Rectangle all{block.x[rows[0]], block.y[rows[0]], block.x[rows[0]], block.y[rows[0]]};
  for (const std::uint32_t r : rows) {
    all.west = std::min(all.west, block.x[r]), all.east = std::max(all.east, block.x[r]);
    all.south = std::min(all.south, block.y[r]), all.north = std::max(all.north, block.y[r]);
  }
  const double width = all.east - all.west, height = all.north - all.south;
  side_ = border_distances * std::sqrt(width * height / static_cast<double>(rows.size()));
  side_ = std::max({side_, std::max(width, height) / most_cells, std::numeric_limits<double>::min()});
  reach_ = 2.0 * max_radius * (1.0 + rounding) + rounding * side_;
  near_ = {where.west - side_, where.south - side_, where.east + side_, where.north + side_};
  corner_ = {all.west, all.south};
  nx_ = static_cast<std::int32_t>(width / side_) + 1;
  ny_ = static_cast<std::int32_t>(height / side_) + 1;
}

std::vector<std::uint32_t> Surroundings::first() {
  if (nx_ == 0) return rows_;
  std::vector<std::uint32_t> inside;
  inside.reserve(rows_.size());
  start_.assign(static_cast<size_t>(nx_) * static_cast<size_t>(ny_) + 1, 0);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> outside;  // cell, row
  for (const std::uint32_t r : rows_) {
    if (holds(near_, block_.x[r], block_.y[r])) {
      inside.push_back(r);
      continue;
    }
    const auto i = static_cast<std::uint32_t>((block_.x[r] - corner_.x) / side_),
               j = static_cast<std::uint32_t>((block_.y[r] - corner_.y) / side_);
    outside.emplace_back(j * static_cast<std::uint32_t>(nx_) + i, r);
    ++start_[outside.back().first + 1];
  }
  state_.assign(start_.size() - 1, 0);
  for (size_t c = 0; c < state_.size(); ++c) {
    if (start_[c + 1] > 0) state_[c] = 1, left_.push_back(static_cast<std::int32_t>(c));
    start_[c + 1] += start_[c];
  }
  sorted_.resize(outside.size());
  std::vector<std::uint32_t> fill(start_.begin(), start_.end() - 1);
  for (const auto& [c, r] : outside) sorted_[fill[c]++] = r;
  if (!inside.empty()) return inside;
  left_.clear();
  return sorted_;
}

Rectangle Surroundings::cell(std::int32_t c) const {
  const double x = corner_.x + side_ * (c % nx_), y = corner_.y + side_ * (c / nx_);
  return {x, y, x + side_, y + side_};
}

bool Surroundings::is_near(const Rectangle& cell, const Rectangle& part) const {
  return cell.west <= part.east + reach_ && cell.east >= part.west - reach_ && cell.south <= part.north + reach_ &&
         cell.north >= part.south - reach_;
}

void Surroundings::mark_disc(double x, double y, double radius, const Rectangle& part) {
  const double reach = radius * (1.0 + rounding) + rounding * side_;
  const auto touch = [&](std::int32_t c) {
    if (state_[c] != 1) return;
    const Rectangle r = cell(c);
    const double dx = std::max({r.west - x, x - r.east, 0.0}), dy = std::max({r.south - y, y - r.north, 0.0});
    if (!(dx * dx + dy * dy > reach * reach) && is_near(r, part)) state_[c] = 2;
  };
  const auto index = [&](double v, std::int32_t n) { return static_cast<std::int32_t>(std::clamp(std::floor(v / side_), 0.0, n - 1.0)); };
  const std::int32_t i0 = index(std::max(x - reach, part.west - reach_) - corner_.x, nx_),
                     i1 = index(std::min(x + reach, part.east + reach_) - corner_.x, nx_);
  const std::int32_t j0 = index(std::max(y - reach, part.south - reach_) - corner_.y, ny_),
                     j1 = index(std::min(y + reach, part.north + reach_) - corner_.y, ny_);
  if (!std::isfinite(x + y + reach) || static_cast<size_t>(i1 - i0 + 1) * static_cast<size_t>(j1 - j0 + 1) > left_.size()) {
    for (const std::int32_t c : left_) touch(c);
    return;
  }
  for (std::int32_t j = j0; j <= j1; ++j)
    for (std::int32_t i = i0; i <= i1; ++i) touch(j * nx_ + i);
}

void Surroundings::mark_half_plane(const Place& a, const Place& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, slack = rounding * std::hypot(dx, dy) * side_;
  const auto reaches = [&](const Rectangle& r) {
    // Its corner farthest to the left of the edge.
    const double x = dy > 0 ? r.west : r.east, y = dx > 0 ? r.north : r.south;
    return dx * (y - a.y) - dy * (x - a.x) >= -slack;
  };
  if (!reaches(where_)) return;
  const Rectangle part = left_of(a, b, where_, slack);
  for (const std::int32_t c : left_)
    if (state_[c] == 1) {
      const Rectangle r = cell(c);
      if (reaches(r) && is_near(r, part)) state_[c] = 2;
    }
}

void Surroundings::mark(const Face& face, const std::vector<Place>& places) {
  const auto at = [&](int k) -> const Place& { return places[static_cast<size_t>(face.v[k])]; };
  if (!face.is_finite()) {
    const int k = face.corner_beyond();
    return mark_half_plane(at((k + 1) % 3), at((k + 2) % 3));
  }
  const Place &a = at(0), &b = at(1), &c = at(2);
  const double west = std::min(std::min(a.x, b.x), c.x), east = std::max(std::max(a.x, b.x), c.x);
  const double south = std::min(std::min(a.y, b.y), c.y), north = std::max(std::max(a.y, b.y), c.y);
  if (east < where_.west || west > where_.east || north < where_.south || south > where_.north) return;
  // The disc lies within its diameter of the triangle: mostly that ends the matter.
  const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
  const double twice_area = bx * cy - by * cx, bb = bx * bx + by * by, cc = cx * cx + cy * cy;
  const double aa = (bx - cx) * (bx - cx) + (by - cy) * (by - cy);
  const double room = std::min(std::min(west - near_.west, near_.east - east), std::min(south - near_.south, near_.north - north));
  if (room > 0.0 && aa * bb * cc < (1.0 - rounding) * room * room * twice_area * twice_area) return;
  mark_disc(a.x + (cy * bb - by * cc) / (2.0 * twice_area), a.y + (bx * cc - cx * bb) / (2.0 * twice_area),
            std::sqrt(aa) * std::sqrt(bb) * std::sqrt(cc) / (2.0 * std::abs(twice_area)),
            {std::max(west, where_.west), std::max(south, where_.south), std::min(east, where_.east), std::min(north, where_.north)});
}

std::vector<std::uint32_t> Surroundings::needed(const Delaunay& dt, const std::vector<Place>& places) {
  std::vector<std::uint32_t> more;
  if (left_.empty()) return more;
  if (dt.faces().empty())
    for (const std::int32_t c : left_) state_[c] = 2;
  for (const Face& face : dt.faces())
    if (settled_ == 0 || std::max({face.v[0], face.v[1], face.v[2]}) >= settled_) mark(face, places);
  settled_ = static_cast<std::int32_t>(places.size());
  std::vector<std::int32_t> still;
  for (const std::int32_t c : left_) {
    if (state_[c] == 1) {
      still.push_back(c);
      continue;
    }
    state_[c] = 0;
    more.insert(more.end(), sorted_.begin() + start_[c], sorted_.begin() + start_[c + 1]);
  }
  left_.swap(still);
  return more;
}

}  // namespace swath::terrain
