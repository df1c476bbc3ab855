// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/line_file.h"

#include <cmath>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/geo/same_map.h"

namespace swath::pipeline {
namespace {

/// Without heights, so that no geoid is asked for.
core::Crs flat(const core::Crs& crs) { return crs.is_geocentric() ? crs : crs.horizontal(); }

/// From the CRS of a file to that of the data; nothing where places stay as they are.
struct Way {
  core::Transform transform;
  std::string from, to;
};
std::optional<Way> way_between(const std::string& file_wkt, const core::Crs& crs) {
  if (crs.empty() || file_wkt.empty()) return std::nullopt;
  const core::Crs from = flat(core::Crs(file_wkt)), to = flat(crs);
  if (core::is_same_map(from, to)) return std::nullopt;
  return Way{core::Transform(from, to), from.name(), to.name()};
}

void move_places(const Way& way, std::vector<double>& x, std::vector<double>& y, const std::filesystem::path& file) {
  std::vector<double> z(x.size(), 0.0);
  if (way.transform.apply(x.data(), y.data(), z.data(), x.size()) > 0)
    throw core::Error("its CRS is " + way.from + ", that of the data " + way.to + ", and a place of it has no coordinates there",
                      file.string(), "is that the CRS of its coordinates? GeoJSON that names none is in degrees of WGS 84");
}

}  // namespace

std::vector<io::VectorLine> read_lines_in(const std::filesystem::path& file, const core::Crs& crs, const std::string& field) {
  io::VectorLines read = io::read_lines(file, field);
  move_into(crs, file, read);
  return std::move(read.lines);
}

void move_into(const core::Crs& crs, const std::filesystem::path& file, io::VectorLines& read) {
  if (const auto way = way_between(read.crs_wkt, crs))
    for (io::VectorLine& line : read.lines) move_places(*way, line.x, line.y, file);
}

void move_into(const core::Crs& crs, const std::filesystem::path& file, io::SpotFile& read) {
  if (const auto way = way_between(read.crs_wkt, crs)) move_places(*way, read.x, read.y, file);
}

bool is_on_a_map(double x, double y) {
  constexpr double farthest = 1e8;  // m or feet
  return std::abs(x) < farthest && std::abs(y) < farthest;
}

std::vector<std::vector<Eigen::Vector2d>> read_rings_in(const std::filesystem::path& file, const core::Crs& crs, std::uint64_t& left_out) {
  std::vector<std::vector<Eigen::Vector2d>> out;
  for (const io::VectorLine& line : read_lines_in(file, crs)) {
    if (!line.closed) continue;
    std::vector<Eigen::Vector2d> ring;
    for (size_t k = 0; k + 1 < line.x.size(); ++k)
      if (is_on_a_map(line.x[k], line.y[k]))
        ring.emplace_back(line.x[k], line.y[k]);
      else
        ++left_out;
    if (ring.size() >= 3) out.push_back(std::move(ring));
  }
  if (out.empty()) throw core::Error("the file holds no polygon and no closed line", file.string());
  return out;
}

}  // namespace swath::pipeline
