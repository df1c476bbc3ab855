// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/copc/cloud_part.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/geo/same_map.h"
#include "io/copc/copc_hierarchy.h"
#include "io/copc/ept.h"
#include "io/las/cloud_crs.h"

namespace swath::io {
namespace {

/// Cubes of a file's coordinates held against the map's area.
class AreaOfNodes {
 public:
  AreaOfNodes(const core::Crs& file, const CloudMap& map) : map_(map) {
    if (!core::is_same_crs(file, map.crs)) transform_.emplace(file, map.crs);
  }

  bool reaches_into(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const {
    constexpr int steps = 4;  // along each side: sides of other projections are curved
    const core::Box& area = map_.area.box;
    std::vector<double> x, y, z;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; j <= steps; ++j) {
        x.push_back(low.x() + (high.x() - low.x()) * i / steps);
        y.push_back(low.y() + (high.y() - low.y()) * j / steps);
        z.push_back(0.5 * (low.z() + high.z()));
      }
    if (transform_) transform_->apply(x.data(), y.data(), z.data(), x.size());
    core::Box box{core::Area::none, core::Area::none, -core::Area::none, -core::Area::none};
    for (std::size_t k = 0; k < x.size(); ++k) {
      const double east = x[k] * map_.unit, north = y[k] * map_.unit;
      if (!std::isfinite(east + north)) return true;
      box = {std::min(box.x0, east), std::min(box.y0, north), std::max(box.x1, east), std::max(box.y1, north)};
    }
    const double slack =
        transform_ ? 0.02 * std::max(box.x1 - box.x0, box.y1 - box.y0) : 0.0;  // what a curved side reaches beyond its points
    box = box.grown(slack);
    return box.x1 >= area.x0 && box.x0 < area.x1 && box.y1 >= area.y0 && box.y0 < area.y1;
  }

 private:
  const CloudMap& map_;
  std::optional<core::Transform> transform_;
};

/// The first level whose points are as dense as asked for.
int level_for(double spacing, std::optional<double> resolution) {
  constexpr int all = 64;
  if (!resolution) return all;
  int level = 0;
  for (; level < all && std::ldexp(spacing, -level) > *resolution; ++level) {
  }
  return level;
}

}  // namespace

CloudPart part_of_cloud(const Survey& survey, const PointFile& file, const CloudMap& map, std::optional<double> resolution) {
  const std::filesystem::path path = resolve(survey, file.file);
  std::vector<std::string> ignored;
  const LasHeader header = read_las_header(path, ignored);
  const std::optional<CopcInfo> info = copc_info(header, path);
  const core::Crs crs = cloud_crs(survey, file);
  constexpr double metres_per_degree = 111e3;
  if (resolution) *resolution /= crs.is_geographic() ? metres_per_degree : crs.metres_per_unit();
  const std::optional<EptNode> node = info ? std::nullopt : ept_node(path);
  if (resolution && !info && !node)
    throw core::usage_error("a resolution is stated, but the file has no levels of detail", path.string(),
                            "leave `resolution` of readers.las out, or give a COPC file or an EPT index");
  const AreaOfNodes area(crs, map);
  CloudPart part{{}, header.point_count, 0};
  if (node) {
    const bool is_finer = resolution && node->level > level_for(std::ldexp(node->spacing, node->level), resolution);
    if (is_finer || !area.reaches_into(node->low, node->high)) std::swap(part.points, part.unread);
    return part;
  }
  if (!info) return part;
  const int deepest = level_for(info->spacing, resolution);
  part.chunks.emplace();
  part.points = 0;
  for (const CopcNode& n : read_copc_nodes(path, header, *info)) {
    const OctreeCube cube = info->cube.of(n.key);
    const auto points = static_cast<std::uint64_t>(n.points);
    if (n.key.level > deepest || !area.reaches_into(cube.low(), cube.centre.array() + cube.half_side)) {
      part.unread += points;
      continue;
    }
    part.chunks->push_back({n.offset, static_cast<std::uint64_t>(n.bytes), points, n.first_record});
    part.points += points;
  }
  if (part.unread == 0) part.chunks.reset();
  return part;
}

}  // namespace swath::io
