// SPDX-License-Identifier: GPL-3.0-or-later
// Terrain model, contours and trajectory as the page draws them.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "io/raster/geotiff.h"
#include "io/records/sbet.h"
#include "io/vector/vector.h"
#include "tools/view/scene.h"

namespace swath::tools {
namespace {

namespace fs = std::filesystem;

constexpr double step = 0.01;  // of heights and vertices, units of the CRS
constexpr double degree_step = 1e-7;
constexpr std::int32_t no_height = std::numeric_limits<std::int32_t>::min();
constexpr std::size_t strip_cells = 1 << 22;  // of a raster that are read at a time
constexpr std::size_t trajectory_vertices = 20000;

void keep(Scene& scene, core::Value& about, Packer& packer) {
  about["columns"] = packer.table;
  std::move(packer.blobs.begin(), packer.blobs.end(), std::back_inserter(scene.blobs));
}

/// A raster, each of its cells the mean of the known ones of a square of the file's.
struct Reduced {
  int nx = 0, ny = 0;
  std::vector<double> sum;
  std::vector<std::uint32_t> count;
};

Reduced reduced(const fs::path& file, const io::RasterInfo& info, int square) {
  Reduced out{(info.nx + square - 1) / square, (info.ny + square - 1) / square, {}, {}};
  const std::size_t n = static_cast<std::size_t>(out.nx) * static_cast<std::size_t>(out.ny);
  out.sum.assign(n, 0.0);
  out.count.assign(n, 0);
  const int rows = std::max<int>(1, static_cast<int>(strip_cells / static_cast<std::size_t>(info.nx)));
  for (int row = 0; row < info.ny; row += rows) {
    const int height = std::min(rows, info.ny - row);
    const io::Raster strip = io::read_raster(file, 1, io::PixelWindow{0, row, info.nx, height});
    for (int j = 0; j < height; ++j)
      for (int i = 0; i < info.nx; ++i) {
        const double v = strip.values[static_cast<std::size_t>(j) * static_cast<std::size_t>(info.nx) + static_cast<std::size_t>(i)];
        if (std::isnan(v)) continue;
        const int from_south = out.ny - 1 - (row + j) / square;
        const std::size_t at =
            static_cast<std::size_t>(from_south) * static_cast<std::size_t>(out.nx) + static_cast<std::size_t>(i / square);
        out.sum[at] += v;
        ++out.count[at];
      }
  }
  return out;
}

/// Vertices nearer to the last one kept than `distance` are left out, but for the ends.
std::vector<std::size_t> thinned(const io::VectorLine& line, double distance) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < line.x.size(); ++k) {
    const bool is_end = k == 0 || k + 1 == line.x.size();
    if (is_end || std::hypot(line.x[k] - line.x[out.back()], line.y[k] - line.y[out.back()]) >= distance) out.push_back(k);
  }
  return out;
}

std::int32_t steps(double v, double base, double unit) { return static_cast<std::int32_t>(std::llround((v - base) / unit)); }

}  // namespace

void add_terrain(Scene& scene, const fs::path& file, const SceneOptions& options) {
  const io::RasterInfo info = io::read_raster_info(file);
  const auto& g = info.geotransform;
  if (g[2] != 0 || g[4] != 0 || g[1] <= 0 || std::abs(g[1] + g[5]) > 1e-6 * g[1])
    throw core::Error("the terrain model is not north up with square cells", file.string());
  const int square = std::max(1, (std::max(info.nx, info.ny) + options.terrain_side - 1) / options.terrain_side);
  const Reduced r = reduced(file, info, square);
  double base = 0.0;
  for (std::size_t k = 0; k < r.sum.size() && base == 0.0; ++k)
    if (r.count[k] > 0) base = std::floor(r.sum[k] / r.count[k]);
  std::vector<std::int32_t> heights;
  heights.reserve(r.sum.size());
  for (std::size_t k = 0; k < r.sum.size(); ++k) heights.push_back(r.count[k] > 0 ? steps(r.sum[k] / r.count[k], base, step) : no_height);
  core::Value& about = scene.table["terrain"];
  about["nx"] = r.nx;
  about["ny"] = r.ny;
  about["cell"] = g[1] * square;
  about["cell_of_file"] = g[1];
  about["west"] = g[0];
  about["south"] = g[3] - r.ny * g[1] * square;
  about["step"] = step;
  about["base"] = base;
  Packer packer("terrain");
  packer.add("height", std::span<const std::int32_t>(heights));
  keep(scene, about, packer);
}

void add_contours(Scene& scene, const fs::path& file, const SceneOptions& options) {
  const io::VectorLines read = io::read_lines(file);
  std::size_t all = 0;
  double x0 = std::numeric_limits<double>::infinity(), y0 = x0, x1 = -x0, y1 = -x0;
  for (const io::VectorLine& line : read.lines) {
    all += line.x.size();
    for (std::size_t k = 0; k < line.x.size(); ++k) {
      x0 = std::min(x0, line.x[k]);
      x1 = std::max(x1, line.x[k]);
      y0 = std::min(y0, line.y[k]);
      y1 = std::max(y1, line.y[k]);
    }
  }
  if (all == 0) return;
  // A step that is doubled until the lines fit.
  double distance = all > options.line_vertices ? std::max(x1 - x0, y1 - y0) / 8000.0 : 0.0;
  std::vector<std::vector<std::size_t>> kept;
  for (;; distance *= 1.5) {
    kept.clear();
    std::size_t n = 0;
    for (const io::VectorLine& line : read.lines) {
      kept.push_back(thinned(line, distance));
      n += kept.back().size();
    }
    if (n <= options.line_vertices || n <= 2 * read.lines.size() || distance == 0.0) break;
  }
  const bool degrees = std::max(std::abs(x1), std::abs(y1)) <= 360.0;
  const double unit = degrees ? degree_step : step;
  std::vector<std::int32_t> x, y, vertices, heights;
  std::vector<std::uint8_t> index;
  for (std::size_t n = 0; n < read.lines.size(); ++n) {
    const io::VectorLine& line = read.lines[n];
    if (std::isnan(line.height)) continue;
    for (const std::size_t k : kept[n]) {
      x.push_back(steps(line.x[k], std::floor(x0), unit));
      y.push_back(steps(line.y[k], std::floor(y0), unit));
    }
    vertices.push_back(static_cast<std::int32_t>(kept[n].size()));
    heights.push_back(steps(line.height, 0.0, step));
    index.push_back(line.index ? 1 : 0);
  }
  core::Value& about = scene.table["contours"];
  about["step"] = unit;
  about["height_step"] = step;
  about["base"] = core::Value(core::Value::Array{std::floor(x0), std::floor(y0), 0.0});
  about["thinned"] = distance;
  Packer packer("contours");
  packer.add("x", std::span<const std::int32_t>(x));
  packer.add("y", std::span<const std::int32_t>(y));
  packer.add("vertices", std::span<const std::int32_t>(vertices));
  packer.add("height", std::span<const std::int32_t>(heights));
  packer.add("index", std::span<const std::uint8_t>(index));
  keep(scene, about, packer);
}

void add_trajectory(Scene& scene, const fs::path& file, const core::Crs& crs) {
  const io::SbetFile sbet(file);
  const std::uint64_t every = std::max<std::uint64_t>(1, sbet.records() / trajectory_vertices);
  const core::Transform to_map(core::wgs84_geodetic(), crs);
  std::vector<std::int32_t> x, y, z;
  Eigen::Vector3d base = Eigen::Vector3d::Zero();
  const double unit = crs.is_geographic() ? degree_step : step;
  std::vector<io::SbetRecord> record;
  constexpr double degree = 180.0 / 3.14159265358979323846;
  for (std::uint64_t k = 0; k < sbet.records(); k += every) {
    sbet.read(k, 1, record);
    const Eigen::Vector3d p = to_map({record[0].longitude * degree, record[0].latitude * degree, record[0].altitude});
    if (k == 0) base = p.array().floor();
    x.push_back(steps(p.x(), base.x(), unit));
    y.push_back(steps(p.y(), base.y(), unit));
    z.push_back(steps(p.z(), base.z(), step));
  }
  core::Value& about = scene.table["trajectory"];
  about["step"] = unit;
  about["height_step"] = step;
  about["base"] = core::Value(core::Value::Array{base.x(), base.y(), base.z()});
  Packer packer("trajectory");
  packer.add("x", std::span<const std::int32_t>(x));
  packer.add("y", std::span<const std::int32_t>(y));
  packer.add("z", std::span<const std::int32_t>(z));
  packer.add("vertices", std::vector<std::int32_t>{static_cast<std::int32_t>(x.size())});
  keep(scene, about, packer);
}

}  // namespace swath::tools
