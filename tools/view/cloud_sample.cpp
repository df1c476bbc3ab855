// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/view/cloud_sample.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/geo/crs.h"
#include "core/geo/same_map.h"
#include "io/copc/copc_hierarchy.h"
#include "io/copc/octree.h"
#include "io/las/cloud_crs.h"
#include "io/las/las_reader.h"

namespace swath::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t batch = 1 << 18;
constexpr double finest_step = 0.001;  // of coordinates in metres or feet: finer digits are noise of the ranging
constexpr core::ColumnSet shown{core::Column::x,
                                core::Column::y,
                                core::Column::z,
                                core::Column::intensity,
                                core::Column::return_number,
                                core::Column::return_count,
                                core::Column::classification,
                                core::Column::flags,
                                core::Column::strip,
                                core::Column::sigma_h,
                                core::Column::sigma_v};

core::ColumnSet not_shown() {
  core::ColumnSet out;
  for (int c = 0; c < core::column_count; ++c)
    if (!shown.has(static_cast<core::Column>(c))) out.add(static_cast<core::Column>(c));
  return out;
}

/// Steele, Lea and Flood 2014: mixes the bits of a number.
std::uint64_t mixed(std::uint64_t v) {
  v += 0x9e3779b97f4a7c15u;
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
  return v ^ (v >> 31);
}

using Source = CloudSources::Source;

/// The first levels of a COPC file that hold `share` of its points.
void take_levels(Source& s, const io::CopcInfo& info, double share) {
  const std::vector<io::CopcNode> nodes = io::read_copc_nodes(s.file, s.header, info);
  std::vector<std::uint64_t> by_level;
  for (const io::CopcNode& n : nodes) {
    by_level.resize(std::max<std::size_t>(by_level.size(), static_cast<std::size_t>(n.key.level) + 1));
    by_level[static_cast<std::size_t>(n.key.level)] += static_cast<std::uint64_t>(n.points);
  }
  const double wanted = share * static_cast<double>(s.header.point_count);
  std::size_t levels = 0;
  for (double sum = 0.0; levels < by_level.size() && sum < wanted; ++levels) sum += static_cast<double>(by_level[levels]);
  if (levels == by_level.size()) return;
  s.part.chunks.emplace();
  s.points = 0;
  for (const io::CopcNode& n : nodes) {
    if (static_cast<std::size_t>(n.key.level) >= levels) continue;
    s.part.chunks->push_back({n.offset, static_cast<std::uint64_t>(n.bytes), static_cast<std::uint64_t>(n.points), n.first_record});
    s.points += static_cast<std::uint64_t>(n.points);
  }
}

void sort_by_place(CloudSample& sample, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const io::OctreeCube cube = io::OctreeCube::around(low, high);
  const core::Block& b = sample.points;
  std::vector<std::uint64_t> codes;
  codes.reserve(b.size());
  for (std::size_t i = 0; i < b.size(); ++i) codes.push_back(io::octree_code(cube, b.origin + Eigen::Vector3d(b.x[i], b.y[i], b.z[i])));
  std::vector<std::uint32_t> order(b.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t p, std::uint32_t q) { return codes[p] < codes[q]; });
  sample.points = core::select(b, order);
}

}  // namespace

CloudSources open_clouds(const std::vector<fs::path>& files) {
  CloudSources out;
  for (const fs::path& file : files) {
    std::vector<std::string> ignored;
    Source s{file, io::read_las_header(file, ignored), {}, 0};
    s.points = s.header.point_count;
    out.points += s.points;
    if (s.points == 0) continue;
    s.part.unused = not_shown();
    out.files.push_back(std::move(s));
  }
  if (out.files.empty()) throw core::Error("no point to show", files.front().string(), "its header counts 0 points");
  const Source* named = nullptr;
  for (const Source& s : out.files) {
    const std::string crs = io::las_crs(s.header).definition;
    if (named && !crs.empty() && !core::is_same_crs(core::Crs(crs), core::Crs(out.crs)))
      throw core::Error("is in another coordinate reference system than " + named->file.string(), s.file.string(),
                        "run configs/cloud.toml over both, which brings clouds to one, and view its output");
    if (!crs.empty() && !named) {
      named = &s;
      out.crs = crs;
    }
  }
  return out;
}

CloudSample sample_clouds(CloudSources clouds, std::uint64_t most, const core::OnProgress& progress) {
  CloudSample sample;
  sample.of = clouds.points;
  std::vector<Source>& sources = clouds.files;
  const double share = static_cast<double>(most) / static_cast<double>(sample.of);
  Eigen::Vector3d low = sources[0].header.min, high = sources[0].header.max;
  std::uint64_t to_read = 0;
  for (Source& s : sources) {
    low = low.cwiseMin(s.header.min);
    high = high.cwiseMax(s.header.max);
    if (const auto info = io::copc_info(s.header, s.file); info && share < 1.0) take_levels(s, *info, share);
    to_read += s.points;
  }
  const io::LasHeader& first = sources[0].header;
  const bool degrees = !clouds.crs.empty() && core::Crs(clouds.crs).is_geographic();
  for (int k = 0; k < 3; ++k) {
    sample.scale[k] = degrees && k < 2 ? first.scale[k] : std::max(first.scale[k], finest_step);
    while ((high[k] - low[k]) / sample.scale[k] > 2e9) sample.scale[k] *= 10.0;
    sample.points.origin[k] = first.offset[k] + std::round((low[k] - first.offset[k]) / sample.scale[k]) * sample.scale[k];
  }
  std::uint64_t read = 0, number = 0;
  for (const Source& s : sources) {
    io::LasReader reader(s.file, 0, s.part);
    core::Block block;
    block.origin = sample.points.origin;
    io::LasTime time;
    time.keep_unknown = true;
    // What a level of a COPC file is too many is left out by the same numbers.
    const double kept = std::min(1.0, share * static_cast<double>(s.header.point_count) / static_cast<double>(s.points));
    const auto below = static_cast<std::uint64_t>(kept * 18446744073709549568.0);
    while (const std::size_t n = reader.read(block, batch, time)) {
      std::vector<std::uint32_t> rows;
      for (std::uint32_t i = 0; i < n; ++i, ++number)
        if (kept >= 1.0 || mixed(number) < below) rows.push_back(i);
      core::append(sample.points, block, rows);
      read += n;
      progress(static_cast<double>(read) / static_cast<double>(to_read), s.file.filename().string());
    }
  }
  sort_by_place(sample, low, high);
  return sample;
}

}  // namespace swath::tools
