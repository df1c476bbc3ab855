// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/plane_cells.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <map>
#include <tuple>

namespace swath::calib {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double returns_per_plane_cell = 10.0;
constexpr double smallest_side = 1.5, largest_side = 5.0;  // m

// Cell -> number of its present look: open addressing, doubled when half full.
class CellTable {
 public:
  static constexpr std::uint32_t none = ~0u;

  std::uint32_t& at(const CellIndex3& c) {
    if (2 * (used_ + 1) > keys_.size()) grow();
    const std::uint64_t key = key_of(c) + 1;  // 0: free
    size_t slot = mixed(key) & (keys_.size() - 1);
    while (keys_[slot] != 0 && keys_[slot] != key) slot = (slot + 1) & (keys_.size() - 1);
    if (keys_[slot] == 0) keys_[slot] = key, values_[slot] = none, ++used_;
    return values_[slot];
  }
  void clear() {
    std::fill(keys_.begin(), keys_.end(), 0);
    used_ = 0;
  }

 private:
  void grow() {
    const std::vector<std::uint64_t> keys = std::move(keys_);
    const std::vector<std::uint32_t> values = std::move(values_);
    keys_.assign(std::max<size_t>(2 * keys.size(), 1 << 16), 0);
    values_.assign(keys_.size(), none);
    for (size_t s = 0; s < keys.size(); ++s) {
      if (keys[s] == 0) continue;
      size_t slot = mixed(keys[s]) & (keys_.size() - 1);
      while (keys_[slot] != 0) slot = (slot + 1) & (keys_.size() - 1);
      keys_[slot] = keys[s], values_[slot] = values[s];
    }
  }
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> values_;
  size_t used_ = 0;
};

}  // namespace

PlaneShape shape_of(const Matrix3d& scatter, double freedom) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> e(scatter / std::max(freedom, 1.0));
  PlaneShape s;
  s.normal = e.eigenvectors().col(0);
  const double sign = std::abs(s.normal.z()) > 1e-9 ? s.normal.z() : std::abs(s.normal.y()) > 1e-9 ? s.normal.y() : s.normal.x();
  if (sign < 0.0) s.normal = -s.normal;
  s.rms = std::sqrt(std::max(e.eigenvalues()[0], 0.0) * freedom / std::max(freedom - 2.0, 1.0));
  s.narrow = std::sqrt(std::max(e.eigenvalues()[1], 0.0));
  s.wide = std::sqrt(std::max(e.eigenvalues()[2], 0.0));
  return s;
}

PlaneCells plane_cells(const ShotStream& stream, LocalPoints& points, std::optional<double> side, std::uint32_t fewest) {
  PlaneCells out;
  std::vector<CellLook> looks;  // of the present line
  CellTable table;
  std::map<int, std::uint32_t> number;  // of a line in the order it came
  std::vector<TieLine> came;
  int present = 0;
  const auto keep = [&] {
    for (const CellLook& l : looks)
      if (l.moments.n >= fewest) out.looks.push_back(l);
    looks.clear();
    table.clear();
  };
  const auto begin = [&](double density) {
    out.density = density;
    out.side =
        side.value_or(density > 0.0 ? std::clamp(std::sqrt(returns_per_plane_cell / density), smallest_side, largest_side) : largest_side);
  };
  stream_points(stream, points, begin, [&](int line, const core::Shots& shots, const PointColumns& p) {
    if (came.empty() || line != present) keep();
    present = line;
    const auto [at, fresh] = number.try_emplace(line, static_cast<std::uint32_t>(came.size()));
    if (fresh) came.push_back({line, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()});
    TieLine& of = came[at->second];
    for (size_t r = 0; r < shots.size(); ++r) {
      if (std::isnan(p.x[r])) continue;
      const double t = shots.time[r];
      of.first = std::min(of.first, t), of.last = std::max(of.last, t);
      if (!is_last_return(shots, r)) continue;
      ++out.returns;
      const CellIndex3 c = cell_of(p.x[r], p.y[r], p.z[r], out.side);
      std::uint32_t& look = table.at(c);
      if (look == CellTable::none || std::abs(t - looks[look].last) > new_look) {
        look = static_cast<std::uint32_t>(looks.size());
        looks.push_back({c, at->second, t, t, {}});
      }
      CellLook& l = looks[look];
      l.first = std::min(l.first, t), l.last = std::max(l.last, t);
      const Vector3d middle = centre_of(c, out.side);
      l.moments.add(static_cast<float>(p.x[r] - middle.x()), static_cast<float>(p.y[r] - middle.y()),
                    static_cast<float>(p.z[r] - middle.z()));
    }
  });
  keep();
  // Lines by id.
  out.lines = came;
  std::sort(out.lines.begin(), out.lines.end(), [](const TieLine& a, const TieLine& b) { return a.id < b.id; });
  std::vector<std::uint32_t> rank(came.size());
  for (std::uint32_t k = 0; k < out.lines.size(); ++k) rank[number.at(out.lines[k].id)] = k;
  for (CellLook& l : out.looks) l.line = rank[l.line];
  std::sort(out.looks.begin(), out.looks.end(),
            [](const CellLook& a, const CellLook& b) { return std::tie(a.cell, a.line, a.first) < std::tie(b.cell, b.line, b.first); });
  return out;
}

}  // namespace swath::calib
