// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/plane_edges.h"

#include <cmath>

namespace swath::calib {

using Eigen::Vector2d;

Occupied::Occupied(const std::vector<Vector2d>& points, double cell) : cell_(cell) {
  for (const Vector2d& p : points) cells_.insert(index(p));
  std::set<std::pair<int, int>> filled;
  for (const auto& [i, j] : cells_)
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di)
        if (!cells_.contains({i + di, j + dj}) && neighbours(i + di, j + dj) >= 6) filled.insert({i + di, j + dj});
  cells_.merge(filled);
}

bool Occupied::surrounds(const Vector2d& p, double margin) const {
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (!cells_.contains(index(p + margin * Vector2d(dx, dy).normalized()))) return false;
  return true;
}

std::pair<int, int> Occupied::index(const Vector2d& p) const {
  return {static_cast<int>(std::floor(p.x() / cell_)), static_cast<int>(std::floor(p.y() / cell_))};
}

int Occupied::neighbours(int i, int j) const {
  int n = 0;
  for (int dj = -1; dj <= 1; ++dj)
    for (int di = -1; di <= 1; ++di) n += (di != 0 || dj != 0) && cells_.contains({i + di, j + dj});
  return n;
}

}  // namespace swath::calib
