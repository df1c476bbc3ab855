// SPDX-License-Identifier: GPL-3.0-or-later
// Pairing of the banks: Sakoe & Chiba 1978, "Dynamic programming algorithm optimization for spoken word recognition", with the squared
// width as cost and a band of `band` vertices around proportional pairing, so that time and memory grow with the river's length only.
// Monotone levels: Ayer et al. 1955, "An empirical distribution function for sampling with incomplete information". Where levels come from
// points, the pooled plateaus are joined by straight lines between their middles: still monotone, without steps.
#include "terrain/water/river.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace swath::terrain {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int split_samples = 256;  // places along the outline tried as ends
constexpr size_t band = 1500;

/// Blocks of equal value of the non-increasing sequence; `weight` 0 entries belong to no block.
struct Block {
  double value, weight;
  double middle;  // weighted mean index
};

std::vector<Block> pooled(const std::vector<double>& values, const std::vector<double>& weights, bool falls, double* sum) {
  std::vector<Block> blocks;
  for (size_t k = 0; k < values.size(); ++k) {
    if (!(weights[k] > 0)) continue;
    blocks.push_back({values[k], weights[k], static_cast<double>(k)});
    while (blocks.size() > 1) {
      Block &before = blocks[blocks.size() - 2], &last = blocks.back();
      if (falls ? last.value <= before.value : last.value >= before.value) break;
      const double weight = before.weight + last.weight;
      before.value = (before.weight * before.value + last.weight * last.value) / weight;
      before.middle = (before.weight * before.middle + last.weight * last.middle) / weight;
      before.weight = weight;
      blocks.pop_back();
    }
  }
  if (!sum) return blocks;
  *sum = 0;
  size_t b = 0;
  double left = blocks.empty() ? 0.0 : blocks[0].weight;
  for (size_t k = 0; k < values.size(); ++k) {
    if (!(weights[k] > 0)) continue;
    if (left < 0.5 * weights[k] && b + 1 < blocks.size()) left += blocks[++b].weight;
    left -= weights[k];
    *sum += weights[k] * (values[k] - blocks[b].value) * (values[k] - blocks[b].value);
  }
  return blocks;
}

/// Values at 0 .. n-1 by straight lines through (middle, value), level beyond the first and the last.
std::vector<double> joined(const std::vector<Block>& blocks, size_t n) {
  std::vector<double> out(n, std::numeric_limits<double>::quiet_NaN());
  if (blocks.empty()) return out;
  size_t b = 0;
  for (size_t k = 0; k < n; ++k) {
    const auto at = static_cast<double>(k);
    while (b + 1 < blocks.size() && blocks[b + 1].middle <= at) ++b;
    if (at <= blocks[b].middle || b + 1 == blocks.size())
      out[k] = blocks[b].value;
    else
      out[k] =
          blocks[b].value + (at - blocks[b].middle) / (blocks[b + 1].middle - blocks[b].middle) * (blocks[b + 1].value - blocks[b].value);
  }
  return out;
}

/// Place on the outline at a length along it.
class Outline {
 public:
  explicit Outline(const std::vector<Vector3d>& ring) : ring_(ring), at_(ring.size() + 1, 0.0) {
    for (size_t k = 0; k < ring.size(); ++k) at_[k + 1] = at_[k] + (ring[(k + 1) % ring.size()] - ring[k]).head<2>().norm();
  }
  double length() const { return at_.back(); }
  size_t vertex_near(double s) const {
    const auto next = std::upper_bound(at_.begin(), at_.end(), s);
    const auto k = static_cast<size_t>(next - at_.begin()) - 1;
    const size_t a = std::min(k, ring_.size() - 1);
    return s - at_[a] <= at_[a + 1] - s ? a : (a + 1) % ring_.size();
  }
  Vector2d place(double s) const {
    const auto next = std::upper_bound(at_.begin(), at_.end(), s);
    const size_t a = std::min(static_cast<size_t>(next - at_.begin()) - 1, ring_.size() - 1);
    const double d = at_[a + 1] - at_[a];
    const Vector2d p = ring_[a].head<2>(), q = ring_[(a + 1) % ring_.size()].head<2>();
    return d > 0 ? Vector2d(p + (s - at_[a]) / d * (q - p)) : p;
  }

 private:
  const std::vector<Vector3d>& ring_;
  std::vector<double> at_;
};

}  // namespace

std::vector<Vector3d> sampled_ring(const std::vector<Vector3d>& ring, double step) {
  std::vector<Vector3d> out;
  for (size_t k = 0; k < ring.size(); ++k) {
    const Vector3d &a = ring[k], d = ring[(k + 1) % ring.size()] - a;
    const double length = d.head<2>().norm();
    if (length == 0.0) continue;
    const int pieces = std::max(1, static_cast<int>(std::ceil(length / step)));
    for (int p = 0; p < pieces; ++p) out.push_back(a + d * (static_cast<double>(p) / pieces));
  }
  return out;
}

namespace {

/// Vertices at the outline's ends: those of the two places opposite along it that make the sum of the widths between least.
std::pair<size_t, size_t> ends_of(const std::vector<Vector3d>& ring) {
  const Outline outline(ring);
  std::vector<Vector2d> p;
  for (int k = 0; k < split_samples; ++k) p.push_back(outline.place(outline.length() * k / split_samples));
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int s = 0; s < split_samples / 2; ++s) {
    double sum = 0.0;
    for (int k = 1; k < split_samples / 2; ++k)
      sum += (p[static_cast<size_t>((s + k) % split_samples)] - p[static_cast<size_t>((s - k + split_samples) % split_samples)]).norm();
    if (sum < least) least = sum, best = s;
  }
  return {outline.vertex_near(outline.length() * best / split_samples),
          outline.vertex_near(outline.length() * (best + split_samples / 2) / split_samples)};
}

/// Pairs of vertices of the two banks.
std::vector<std::pair<size_t, size_t>> rungs_of(const std::vector<Vector3d>& ring, const Banks& banks) {
  // cost(i, j): least sum of squared widths of a pairing that has come to (i, j).
  const size_t rows = banks.left.size(), columns = banks.right.size();
  const auto first = [&](size_t i) {
    const size_t middle = rows > 1 ? i * (columns - 1) / (rows - 1) : 0;
    return middle > band ? middle - band : 0;
  };
  const auto last = [&](size_t i) { return std::min(columns - 1, (rows > 1 ? i * (columns - 1) / (rows - 1) : columns - 1) + band); };
  enum : std::uint8_t { none, from_left, from_right, from_both };
  std::vector<std::vector<std::uint8_t>> step(rows);
  std::vector<double> before, here;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < rows; ++i) {
    const size_t j0 = first(i), j1 = last(i);
    here.assign(j1 - j0 + 1, infinite);
    step[i].assign(here.size(), none);
    for (size_t j = j0; j <= j1; ++j) {
      const double width = (ring[banks.left[i]] - ring[banks.right[j]]).head<2>().squaredNorm();
      const auto above = [&](size_t column) {
        return i == 0 || column < first(i - 1) || column > last(i - 1) ? infinite : before[column - first(i - 1)];
      };
      const double both = j > 0 ? above(j - 1) : infinite, left = above(j), right = j > j0 ? here[j - 1 - j0] : infinite;
      double cost = both;
      step[i][j - j0] = from_both;
      if (left < cost) cost = left, step[i][j - j0] = from_left;
      if (right < cost) cost = right, step[i][j - j0] = from_right;
      if (i == 0 && j == 0) cost = 0.0, step[i][j - j0] = none;
      here[j - j0] = cost + width;
    }
    std::swap(before, here);
  }
  std::vector<std::pair<size_t, size_t>> rungs;
  for (size_t i = rows - 1, j = columns - 1;;) {
    rungs.emplace_back(i, j);
    const std::uint8_t s = step[i][j - first(i)];
    if (s == none || (i == 0 && j == 0)) break;
    if (s != from_right) --i;
    if (s != from_left) --j;
  }
  std::reverse(rungs.begin(), rungs.end());
  return rungs;
}

}  // namespace

Banks banks_of(const std::vector<Vector3d>& ring) {
  const size_t n = ring.size();
  const auto [begin, end] = ends_of(ring);
  Banks banks;
  for (size_t k = begin;; k = (k + 1) % n) {
    banks.left.push_back(k);
    if (k == end) break;
  }
  for (size_t k = begin;; k = (k + n - 1) % n) {
    banks.right.push_back(k);
    if (k == end) break;
  }
  banks.rungs = rungs_of(ring, banks);
  return banks;
}

std::vector<double> monotone(const std::vector<double>& values, const std::vector<double>& weights, bool falls, double* sum) {
  return joined(pooled(values, weights, falls, sum), values.size());
}

void make_banks_fall(std::vector<Vector3d>& ring, const Banks& banks) {
  std::array<std::vector<double>, 2> heights;
  for (const size_t v : banks.left) heights[0].push_back(ring[v].z());
  for (const size_t v : banks.right) heights[1].push_back(ring[v].z());
  std::array<double, 2> sums{0.0, 0.0};  // rising, falling
  for (const bool falls : {false, true})
    for (const auto& h : heights) {
      double sum = 0;
      pooled(h, std::vector<double>(h.size(), 1.0), falls, &sum);
      sums[falls] += sum;
    }
  const bool falls = sums[1] <= sums[0];
  const auto apply = [&](const std::vector<size_t>& bank, const std::vector<double>& h) {
    const std::vector<double> level = monotone(h, std::vector<double>(h.size(), 1.0), falls);
    for (size_t k = 1; k + 1 < bank.size(); ++k) ring[bank[k]].z() = level[k];
    return std::pair(level.front(), level.back());
  };
  const auto [a0, a1] = apply(banks.left, heights[0]);
  const auto [b0, b1] = apply(banks.right, heights[1]);
  ring[banks.left.front()].z() = falls ? std::max(a0, b0) : std::min(a0, b0);
  ring[banks.left.back()].z() = falls ? std::min(a1, b1) : std::max(a1, b1);
}

void level_across(std::vector<Vector3d>& ring, const Banks& banks, const std::vector<double>& values, const std::vector<double>& weights) {
  double falling = 0, rising = 0;
  pooled(values, weights, true, &falling);
  pooled(values, weights, false, &rising);
  const std::vector<double> level = monotone(values, weights, falling <= rising);
  // A vertex of several rungs takes the middle of the first and the last: a monotone function of its place along the bank.
  std::map<size_t, std::pair<double, double>> ends;
  for (size_t k = 0; k < banks.rungs.size(); ++k)
    for (const size_t v : {banks.left[banks.rungs[k].first], banks.right[banks.rungs[k].second]})
      ends.try_emplace(v, level[k], level[k]).first->second.second = level[k];
  for (const auto& [v, range] : ends) ring[v].z() = 0.5 * (range.first + range.second);
  ring[banks.left.front()].z() = level.front();
  ring[banks.left.back()].z() = level.back();
}

Tin river_surface(const std::vector<Vector3d>& ring, const Banks& banks) {
  Tin tin;
  std::vector<size_t> order(ring.size());
  for (size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::sort(order.begin(), order.end(), [&](size_t p, size_t q) {
    return std::make_tuple(ring[p].x(), ring[p].y(), ring[p].z(), p) < std::make_tuple(ring[q].x(), ring[q].y(), ring[q].z(), q);
  });
  std::vector<std::int32_t> index(ring.size());
  for (const size_t v : order) {
    if (tin.x.empty() || tin.x.back() != ring[v].x() || tin.y.back() != ring[v].y()) {
      tin.x.push_back(ring[v].x());
      tin.y.push_back(ring[v].y());
      tin.z.push_back(ring[v].z());
    }
    index[v] = static_cast<std::int32_t>(tin.x.size()) - 1;
  }
  const auto emit = [&](size_t a, size_t b, size_t c) {
    std::array<std::int32_t, 3> t{index[a], index[b], index[c]};
    std::sort(t.begin(), t.end());
    const double area =
        (tin.x[t[1]] - tin.x[t[0]]) * (tin.y[t[2]] - tin.y[t[0]]) - (tin.y[t[1]] - tin.y[t[0]]) * (tin.x[t[2]] - tin.x[t[0]]);
    if (t[0] != t[1] && t[1] != t[2] && area != 0.0) tin.triangles.push_back(t);
  };
  for (size_t k = 1; k < banks.rungs.size(); ++k) {
    const auto [i0, j0] = banks.rungs[k - 1];
    const auto [i1, j1] = banks.rungs[k];
    if (i1 != i0) emit(banks.left[i0], banks.left[i1], banks.right[j0]);
    if (j1 != j0) emit(banks.left[i1], banks.right[j0], banks.right[j1]);
  }
  return tin;
}

}  // namespace swath::terrain
