// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/local_patch.h"

#include <algorithm>

#include "core/grid.h"

namespace swath::calib {

using Eigen::Vector3d;

LocalPatch::LocalPatch(const OrientedImages& images, const core::Box& box)
    : height_(images.map.in_metres(images.middle).z()),
      i0_(core::cell_index(box.x0, spacing)),
      j0_(core::cell_index(box.y0, spacing)),
      nx_(static_cast<int>(core::cell_index(box.x1, spacing) - i0_) + 2),
      ny_(static_cast<int>(core::cell_index(box.y1, spacing) - j0_) + 2) {
  constexpr double rise = 100.0;  // m
  const BlockFrame frame = images.frame();
  const auto local = [&](double x, double y, double z) { return frame.local_of(images.map.in_units({x, y, z})); };
  nodes_.reserve(static_cast<size_t>(nx_) * static_cast<size_t>(ny_));
  for (int j = 0; j < ny_; ++j)
    for (int i = 0; i < nx_; ++i) {
      const double x = static_cast<double>(i0_ + i) * spacing, y = static_cast<double>(j0_ + j) * spacing;
      const Vector3d here = local(x, y, height_);
      nodes_.push_back({here, (here - local(x, y, height_ - rise)) / rise});
    }
}

Vector3d LocalPatch::operator()(const Vector3d& map) const {
  const double u = map.x() / spacing, v = map.y() / spacing;
  const std::int64_t i = core::floor_of(u), j = core::floor_of(v);
  const double a = u - static_cast<double>(i), b = v - static_cast<double>(j);
  const auto node = [&](std::int64_t c, std::int64_t r) -> const Node& {
    const auto column = static_cast<size_t>(std::clamp<std::int64_t>(c - i0_, 0, nx_ - 1)),
               row = static_cast<size_t>(std::clamp<std::int64_t>(r - j0_, 0, ny_ - 1));
    return nodes_[row * static_cast<size_t>(nx_) + column];
  };
  const Node &p = node(i, j), &q = node(i + 1, j), &r = node(i, j + 1), &s = node(i + 1, j + 1);
  const double wp = (1 - a) * (1 - b), wq = a * (1 - b), wr = (1 - a) * b, ws = a * b, z = map.z() - height_;
  return wp * (p.place + z * p.up) + wq * (q.place + z * q.up) + wr * (r.place + z * r.up) + ws * (s.place + z * s.up);
}

}  // namespace swath::calib
