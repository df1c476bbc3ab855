// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/line_file.h"

#include <cmath>
#include <utility>

#include "core/error.h"

namespace swath::pipeline {
namespace {

constexpr double farthest = 1e8;  // m or feet: no map projection reaches it

/// Without heights, so that no geoid is asked for.
core::Crs flat(const core::Crs& crs) { return crs.is_geocentric() ? crs : crs.horizontal(); }

}  // namespace

std::vector<io::VectorLine> read_lines_in(const std::filesystem::path& file, const core::Crs& crs) {
  io::VectorLines read = io::read_lines(file);
  if (crs.empty() || read.crs_wkt.empty()) return std::move(read.lines);
  const core::Crs from = flat(core::Crs(read.crs_wkt)), to = flat(crs);
  if (from.key() == to.key() || (from.epsg() != 0 && from.epsg() == to.epsg())) return std::move(read.lines);
  const core::Transform transform(from, to);
  for (io::VectorLine& line : read.lines) {
    std::vector<double> z(line.x.size(), 0.0);
    if (transform.apply(line.x.data(), line.y.data(), z.data(), line.x.size()) > 0)
      throw core::Error("its CRS is " + from.name() + ", that of the data " + to.name() + ", and a place of it has no coordinates there",
                        file.string(), "is that the CRS of its coordinates? GeoJSON that names none is in degrees of WGS 84");
  }
  return std::move(read.lines);
}

std::vector<std::vector<Eigen::Vector2d>> read_rings_in(const std::filesystem::path& file, const core::Crs& crs, std::uint64_t& left_out) {
  std::vector<std::vector<Eigen::Vector2d>> out;
  for (const io::VectorLine& line : read_lines_in(file, crs)) {
    if (!line.closed) continue;
    std::vector<Eigen::Vector2d> ring;
    for (size_t k = 0; k + 1 < line.x.size(); ++k)
      if (std::abs(line.x[k]) < farthest && std::abs(line.y[k]) < farthest)
        ring.emplace_back(line.x[k], line.y[k]);
      else
        ++left_out;
    if (ring.size() >= 3) out.push_back(std::move(ring));
  }
  if (out.empty()) throw core::Error("the file holds no polygon and no closed line", file.string());
  return out;
}

}  // namespace swath::pipeline
