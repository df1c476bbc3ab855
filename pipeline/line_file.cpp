// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/line_file.h"

#include "core/error.h"

namespace swath::pipeline {
namespace {

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

}  // namespace swath::pipeline
