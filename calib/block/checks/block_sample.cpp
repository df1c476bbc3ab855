// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/block_sample.h"

#include <algorithm>
#include <numeric>

namespace swath::calib {
namespace {

/// Rays by point.
std::vector<std::vector<std::uint32_t>> rays_by_point(const ImageBlock& block) {
  std::vector<std::vector<std::uint32_t>> out(block.points.size());
  for (std::uint32_t r = 0; r < block.rays.size(); ++r) out[block.rays[r].point].push_back(r);
  return out;
}

/// Points that several images see, those that most strips see first, and of them those with the most rays.
std::vector<std::uint32_t> best_first(const ImageBlock& block, const std::vector<std::vector<std::uint32_t>>& rays) {
  std::vector<std::pair<size_t, size_t>> rank(block.points.size());
  std::vector<std::uint32_t> order;
  std::vector<int> strips;
  for (std::uint32_t p = 0; p < rank.size(); ++p) {
    if (rays[p].size() < 2) continue;
    strips.clear();
    for (const std::uint32_t r : rays[p]) strips.push_back(block.images[block.rays[r].image].strip);
    std::sort(strips.begin(), strips.end());
    rank[p] = {static_cast<size_t>(std::unique(strips.begin(), strips.end()) - strips.begin()), rays[p].size()};
    order.push_back(p);
  }
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return rank[a] > rank[b]; });
  return order;
}

/// `wanted`: per point; control is taken in any case.
ReadBlock part_of(const ReadBlock& read, std::vector<char> wanted) {
  const ImageBlock& b = read.block;
  for (const BlockControl& c : b.control) wanted[c.point] = 1;
  ReadBlock out = read;
  out.block.points.clear();
  out.block.rays.clear();
  std::vector<std::uint32_t> number(b.points.size(), 0);
  for (size_t p = 0; p < wanted.size(); ++p)
    if (wanted[p]) number[p] = static_cast<std::uint32_t>(out.block.points.size()), out.block.points.push_back(b.points[p]);
  for (ImageRay r : b.rays)
    if (wanted[r.point]) r.point = number[r.point], out.block.rays.push_back(r);
  for (BlockControl& c : out.block.control) c.point = number[c.point];
  return out;
}

}  // namespace

ReadBlock sample_of(const ReadBlock& read, size_t points) {
  std::vector<std::uint32_t> order = best_first(read.block, rays_by_point(read.block));
  order.resize(std::min(order.size(), points));
  std::vector<char> wanted(read.block.points.size(), 0);
  for (const std::uint32_t p : order) wanted[p] = 1;
  return part_of(read, std::move(wanted));
}

ReadBlock sample_by_image(const ReadBlock& read, int per_image) {
  const ImageBlock& b = read.block;
  const auto rays = rays_by_point(b);
  std::vector<char> wanted(b.points.size(), 0);
  std::vector<int> has(b.images.size(), 0);
  for (const std::uint32_t p : best_first(b, rays)) {
    const auto lacks = [&](std::uint32_t r) { return has[b.rays[r].image] < per_image; };
    if (std::none_of(rays[p].begin(), rays[p].end(), lacks)) continue;
    wanted[p] = 1;
    for (const std::uint32_t r : rays[p]) ++has[b.rays[r].image];
  }
  return part_of(read, std::move(wanted));
}

}  // namespace swath::calib
