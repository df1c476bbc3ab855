// SPDX-License-Identifier: GPL-3.0-or-later
// The ray goes from column to column (Amanatides1987, in plan); in each its lowest place is held against the column's top.
#include "calib/block/imagery/sight.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/floor_div.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

constexpr double never = std::numeric_limits<double>::infinity();

bool stands_in_the_way(const core::Block& b, size_t i) {
  return core::is_usable(b, i) && (b.classification.empty() || b.classification[i] != core::point_class::wire);
}

/// One axis of a walk through columns: where the ray crosses into the next.
struct Axis {
  std::int64_t at;
  int step;
  double next, apart;  ///< distance along the ray: to the next border, between borders

  Axis(double start, double way, double side) : at(core::floor_of(start / side)), step(way > 0.0 ? 1 : -1), next(never), apart(never) {
    if (way == 0.0) return;
    const double border = static_cast<double>(at + (way > 0.0 ? 1 : 0)) * side;
    next = (border - start) / way;
    apart = side / std::abs(way);
  }
};

}  // namespace

core::Grid tops_of(const core::Block& b, double cell) {
  double x0 = never, y0 = never, x1 = -never, y1 = -never;
  for (size_t k = 0; k < b.size(); ++k) {
    if (!stands_in_the_way(b, k)) continue;
    const double x = b.x[k] + b.origin.x(), y = b.y[k] + b.origin.y();
    x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
  }
  if (x1 < x0) return core::Grid();
  const std::int64_t i0 = core::cell_index(x0, cell), j0 = core::cell_index(y0, cell);
  core::Grid out(
      {cell, i0, j0, static_cast<int>(core::cell_index(x1, cell) - i0 + 1), static_cast<int>(core::cell_index(y1, cell) - j0 + 1)});
  for (size_t k = 0; k < b.size(); ++k) {
    if (!stands_in_the_way(b, k)) continue;
    const auto i = static_cast<int>(core::cell_index(b.x[k] + b.origin.x(), cell) - i0),
               j = static_cast<int>(core::cell_index(b.y[k] + b.origin.y(), cell) - j0);
    float& top = out.height[out.lattice.at(i, j)];
    const auto z = static_cast<float>(b.z[k] + b.origin.z());
    if (!(top >= z)) top = z;
  }
  return out;
}

Sight::Sight(const core::Grid& tops, double reach) : grid_(tops), reach_(reach) { find_tops(); }

void Sight::find_tops() {
  const core::Lattice& l = grid_.lattice;
  squares_x_ = (l.nx + square_ - 1) / square_, squares_y_ = (l.ny + square_ - 1) / square_;
  const auto at = [&](int i, int j) { return static_cast<size_t>(j) * static_cast<size_t>(squares_x_) + static_cast<size_t>(i); };
  std::vector<double> own(static_cast<size_t>(squares_x_) * static_cast<size_t>(squares_y_), -never);
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      const float h = grid_.height[l.at(i, j)];
      if (!std::isfinite(h)) continue;
      double& top = own[at(i / square_, j / square_)];
      top = std::max(top, static_cast<double>(h));
    }
  const int around = static_cast<int>(std::ceil(reach_ / (square_ * l.cell))) + 1;
  std::vector<double> along(own.size(), -never);
  tops_.assign(own.size(), -never);
  for (int j = 0; j < squares_y_; ++j)
    for (int i = 0; i < squares_x_; ++i)
      for (int k = std::max(0, i - around); k <= std::min(squares_x_ - 1, i + around); ++k)
        along[at(i, j)] = std::max(along[at(i, j)], own[at(k, j)]);
  for (int j = 0; j < squares_y_; ++j)
    for (int i = 0; i < squares_x_; ++i)
      for (int k = std::max(0, j - around); k <= std::min(squares_y_ - 1, j + around); ++k)
        tops_[at(i, j)] = std::max(tops_[at(i, j)], along[at(i, k)]);
}

double Sight::top_near(std::int64_t i, std::int64_t j) const {
  const core::Lattice& l = grid_.lattice;
  if (l.size() == 0) return -never;
  const auto square = [](std::int64_t v, int n) { return static_cast<size_t>(std::clamp<std::int64_t>(v, 0, n - 1) / square_); };
  return tops_[square(j - l.j0, l.ny) * static_cast<size_t>(squares_x_) + square(i - l.i0, l.nx)];
}

bool Sight::is_hidden(const Vector3d& place, const Vector3d& camera, double clearance) const {
  const core::Lattice& l = grid_.lattice;
  const Vector3d way = (camera - place).normalized();
  if (!(way.z() > 0.0)) return false;
  const double level = way.head<2>().norm();
  const double near = clearance / way.z(), far = level > 0.0 ? reach_ / level : never;  // along the ray
  const Vector3d start = place + near * way;
  const double top = top_near(core::cell_index(place.x(), l.cell), core::cell_index(place.y(), l.cell));
  const double last = std::min(far - near, (top - start.z()) / way.z());
  Axis x(start.x(), way.x(), l.cell), y(start.y(), way.y(), l.cell);
  double s = 0.0;
  while (s < last) {
    const std::int64_t i = x.at - l.i0, j = y.at - l.j0;
    if (i >= 0 && j >= 0 && i < l.nx &&
        j<l.ny&& static_cast<double>(grid_.height[l.at(static_cast<int>(i), static_cast<int>(j))])> start.z() + s * way.z())
      return true;
    Axis& crossed = x.next < y.next ? x : y;
    s = crossed.next;
    crossed.at += crossed.step;
    crossed.next += crossed.apart;
  }
  return false;
}

}  // namespace swath::calib
