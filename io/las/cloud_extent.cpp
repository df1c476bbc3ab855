// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/cloud_extent.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

#include "core/block.h"
#include "io/las/las_reader.h"

namespace swath::io {
namespace {

constexpr double farthest = 1e9;             // cells and metres alike: no map projection reaches it
constexpr size_t max_cells = 1u << 20;       // then cells are joined by fours
constexpr double min_margin = 30.0;          // cells
constexpr double margin = 3.0;               // sides of the box of the middle half
constexpr std::uint64_t group_points = 100;  // that count as a part of the cloud wherever they lie
constexpr double one_place = 1e-3;           // of a cell
constexpr double max_wild = 0.25;            // of the points: where more are far from the others, none is known to be wrong
constexpr std::uint64_t min_points = 20;     // of a cloud that is judged
constexpr size_t extent_batch = 1u << 16;

/// Cells that a quarter of the points lies below, and above.
std::pair<std::int64_t, std::int64_t> middle_half(std::vector<std::pair<std::int64_t, std::uint64_t>> cells, std::uint64_t points) {
  std::sort(cells.begin(), cells.end());
  std::pair<std::int64_t, std::int64_t> out{cells.front().first, cells.back().first};
  std::uint64_t below = 0;
  bool has_low = false;
  for (const auto& [at, n] : cells) {
    below += n;
    if (!has_low && 4 * below > points) out.first = at, has_low = true;
    if (4 * below >= 3 * points) {
      out.second = at;
      break;
    }
  }
  return out;
}

}  // namespace

void CloudExtent::Cell::add(const Cell& o) {
  points += o.points;
  x0 = std::min(x0, o.x0);
  y0 = std::min(y0, o.y0);
  x1 = std::max(x1, o.x1);
  y1 = std::max(y1, o.y1);
}

CloudExtent::Key CloudExtent::key(double x, double y) const {
  return {static_cast<std::int64_t>(std::floor(x / cell_)), static_cast<std::int64_t>(std::floor(y / cell_))};
}

void CloudExtent::add(double x, double y) {
  if (!(std::abs(x) < farthest && std::abs(y) < farthest)) return;
  const Key k = key(x, y);
  if (!last_ || last_->first != k) {
    last_ = &*cells_.try_emplace(k).first;
    if (cells_.size() > max_cells) {
      while (cells_.size() > max_cells) coarsen();
      last_ = &*cells_.try_emplace(key(x, y)).first;
    }
  }
  last_->second.add({1, x, y, x, y});
}

void CloudExtent::coarsen() {
  cell_ *= 2.0;
  std::map<Key, Cell> coarse;
  for (const auto& [k, c] : cells_) coarse[{k.first >> 1, k.second >> 1}].add(c);
  cells_ = std::move(coarse);
}

void CloudExtent::find_box() {
  std::uint64_t points = 0;
  std::vector<std::pair<std::int64_t, std::uint64_t>> across, up;
  for (const auto& [k, c] : cells_) {
    points += c.points;
    across.emplace_back(k.first, c.points);
    up.emplace_back(k.second, c.points);
  }
  std::tie(i0_, i1_) = middle_half(std::move(across), points);
  std::tie(j0_, j1_) = middle_half(std::move(up), points);
  const auto side = static_cast<double>(std::max(i1_ - i0_, j1_ - j0_) + 1);
  auto grown = static_cast<std::int64_t>(std::ceil(std::max(min_margin, margin * side)));
  if (points < min_points) grown = static_cast<std::int64_t>(2.0 * farthest / cell_) + 1;
  i0_ -= grown;
  i1_ += grown;
  j0_ -= grown;
  j1_ += grown;
}

void CloudExtent::judge_groups() {
  std::set<Key> open;
  double points = 0, far = 0;
  for (const auto& [k, c] : cells_) {
    points += static_cast<double>(c.points);
    if (!in_box(k)) open.insert(k);
  }
  std::vector<Key> single;
  while (!open.empty()) {
    std::vector<Key> group{*open.begin()};
    open.erase(open.begin());
    Cell whole;
    bool joins_box = false;
    for (size_t at = 0; at < group.size(); ++at) {
      const Key k = group[at];
      whole.add(cells_.at(k));
      for (std::int64_t dj = -1; dj <= 1; ++dj)
        for (std::int64_t di = -1; di <= 1; ++di) {
          const Key next{k.first + di, k.second + dj};
          joins_box = joins_box || (in_box(next) && cells_.contains(next));
          if (open.erase(next) > 0) group.push_back(next);
        }
    }
    const bool many = whole.points >= group_points && std::max(whole.x1 - whole.x0, whole.y1 - whole.y0) > one_place * cell_;
    if (many || joins_box) continue;
    far += static_cast<double>(whole.points);
    single.insert(single.end(), group.begin(), group.end());
  }
  if (far > max_wild * points) return;
  for (const Key& k : single) cells_.erase(k);
}

void CloudExtent::settle() {
  last_ = nullptr;
  if (cells_.empty()) return;
  find_box();
  judge_groups();
  for (const auto& [k, c] : cells_) {
    points_ += c.points;
    low_ = low_.cwiseMin(Eigen::Vector2d(c.x0, c.y0));
    high_ = high_.cwiseMax(Eigen::Vector2d(c.x1, c.y1));
  }
}

bool CloudExtent::holds(double x, double y) const {
  if (!(std::abs(x) < farthest && std::abs(y) < farthest)) return false;
  const Key k = key(x, y);
  return in_box(k) || cells_.contains(k);
}

CloudExtent CloudExtent::of_box(double cell, const Eigen::Vector2d& low, const Eigen::Vector2d& high, std::uint64_t points) {
  CloudExtent out(cell);
  constexpr auto around = static_cast<std::int64_t>(min_margin);
  const Key first = out.key(low.x(), low.y()), last = out.key(high.x(), high.y());
  out.i0_ = first.first - around;
  out.j0_ = first.second - around;
  out.i1_ = last.first + around;
  out.j1_ = last.second + around;
  out.points_ = points;
  out.is_stated_ = true;
  out.low_ = low;
  out.high_ = high;
  return out;
}

namespace {

/// All columns but the coordinates.
core::ColumnSet places_alone() {
  using core::Column;
  core::ColumnSet unused{Column::source};
  core::for_each_column([&](Column c, const char*, auto) {
    if (c != Column::x && c != Column::y && c != Column::z) unused.add(c);
  });
  return unused;
}

/// Is the header's box so narrow that none of its points can be far from the others, and are these points in it?
bool is_plausible_box(const LasHeader& h, double cell, const LasPoints& points) {
  const Eigen::Array2d low = h.min.head<2>(), high = h.max.head<2>();
  if (!(low.abs().maxCoeff() < farthest && high.abs().maxCoeff() < farthest)) return false;
  if (!((high - low).minCoeff() >= 0.0 && (high - low).maxCoeff() <= min_margin * cell)) return false;
  const Eigen::Array2d slack = h.scale.head<2>().array().abs();
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Array2d p(points.x[i], points.y[i]);
    if (!((p >= low - slack).all() && (p <= high + slack).all())) return false;
  }
  return true;
}

}  // namespace

FileExtent extent_of_cloud(const std::filesystem::path& file, double cell, double lowest, double highest, unsigned threads) {
  FileExtent out{CloudExtent(cell)};
  LasReader reader(file, threads, {{}, places_alone()});
  LasPoints points;
  if (reader.read(points, extent_batch) == 0) return out;
  const LasHeader& h = reader.header();
  if (is_plausible_box(h, cell, points) && h.min.z() >= lowest && h.max.z() <= highest)
    return {CloudExtent::of_box(cell, h.min.head<2>(), h.max.head<2>(), h.point_count)};
  double beyond = 0, all = 0;
  do {
    for (size_t i = 0; i < points.size(); ++i) {
      out.places.add(points.x[i], points.y[i]);
      beyond += !(points.z[i] >= lowest && points.z[i] <= highest);
    }
    all += static_cast<double>(points.size());
  } while (reader.read(points, extent_batch) > 0);
  out.places.settle();
  out.has_few_wild_heights = beyond <= max_wild * all;
  return out;
}

}  // namespace swath::io
