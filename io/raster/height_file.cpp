// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster/height_file.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "io/raster/geotiff.h"

namespace swath::io {
namespace {

constexpr double most_pixels = 4e8;
constexpr int rim = 2;  // pixels around a box, so that heights between pixels are known up to its edge

/// The pixels that the box (in units of the file) touches; nothing where it touches none.
std::optional<PixelWindow> window_of(const RasterInfo& info, const core::Box& box) {
  const auto& g = info.geotransform;
  const auto column = [&](double x) { return std::clamp(std::floor((x - g[0]) / g[1]), -10.0, info.nx + 10.0); };
  const auto row = [&](double y) { return std::clamp(std::floor((y - g[3]) / g[5]), -10.0, info.ny + 10.0); };
  const int first = std::max(0, static_cast<int>(column(box.x0)) - rim),
            last = std::min(info.nx, static_cast<int>(column(box.x1)) + rim + 1);
  const int top = std::max(0, static_cast<int>(row(box.y1)) - rim), bottom = std::min(info.ny, static_cast<int>(row(box.y0)) + rim + 1);
  if (first >= last || top >= bottom) return std::nullopt;
  return PixelWindow{first, top, last - first, bottom - top};
}

/// What is known of a raster before its pixels are read.
struct Opened {
  RasterInfo info;
  core::Crs crs;
  double metre = 1.0;
};

Opened opened(const std::filesystem::path& file) {
  Opened out{read_raster_info(file), {}};
  const auto& g = out.info.geotransform;
  if (!std::all_of(g.begin(), g.end(), [](double v) { return std::isfinite(v); }) || g[2] != 0 || g[4] != 0 || g[1] <= 0 || g[5] >= 0)
    throw core::Error("the raster is not north up", file.string(), "warp it to the survey's CRS first (gdalwarp)");
  if (!out.info.crs_wkt.empty()) out.crs = core::Crs(out.info.crs_wkt);
  out.metre = out.crs.empty() ? 1.0 : out.crs.metres_per_unit();
  if (out.metre == 0.0) throw core::Error("the raster is in degrees", file.string(), "warp it to a projected CRS first (gdalwarp -t_srs)");
  return out;
}

std::optional<PixelWindow> window_in(const Opened& o, const core::Box& box) {
  return window_of(o.info, {box.x0 / o.metre, box.y0 / o.metre, box.x1 / o.metre, box.y1 / o.metre});
}

/// Nothing where no pixel of the window has a height.
std::optional<HeightFile> heights_in(const std::filesystem::path& file, const Opened& o, const PixelWindow& w,
                                     const OnImpossible& on_impossible = {}) {
  if (static_cast<double>(w.columns) * w.rows > most_pixels)
    throw core::Error("more than 400 million pixels lie in the area", file.string(), "take a coarser model (gdalwarp -tr -r average)");
  const Raster r = read_raster(file, 1, w);
  const double unit = height_unit_of(file), metre = o.metre;
  const HeightRule rule(unit, o.info.nodata[0]);
  const auto& t = r.geotransform;
  std::vector<float> heights(r.values.size());
  for (int j = 0; j < r.ny; ++j)
    for (int i = 0; i < r.nx; ++i) {
      double v = r.values[static_cast<size_t>(j) * static_cast<size_t>(r.nx) + static_cast<size_t>(i)];
      if (rule.is_impossible(v)) {
        if (on_impossible) on_impossible((t[0] + (i + 0.5) * t[1]) * metre, (t[3] + (j + 0.5) * t[5]) * metre, v);
        v = std::numeric_limits<double>::quiet_NaN();
      }
      heights[static_cast<size_t>(r.ny - 1 - j) * static_cast<size_t>(r.nx) + static_cast<size_t>(i)] = static_cast<float>(v * unit);
    }
  if (std::none_of(heights.begin(), heights.end(), [](float h) { return std::isfinite(h); })) return std::nullopt;
  HeightFile out{core::HeightField(), o.crs};
  out.field = core::HeightField(
      {(t[0] + 0.5 * t[1]) * metre, (t[3] + (r.ny - 0.5) * t[5]) * metre, t[1] * metre, -t[5] * metre, r.nx, r.ny}, std::move(heights));
  return out;
}

}  // namespace

double height_unit_of(const std::filesystem::path& file) {
  const RasterInfo info = read_raster_info(file);
  return metres_per_height(info.units.empty() ? "" : info.units[0], info.crs_wkt);
}

HeightFile read_heights(const std::filesystem::path& file, const std::optional<core::Box>& within) {
  const Opened o = opened(file);
  PixelWindow w{0, 0, o.info.nx, o.info.ny};
  if (within) {
    const std::optional<PixelWindow> part = window_in(o, *within);
    if (!part) throw core::Error("the raster lies beside the area", file.string(), "is it of this place, and in the same CRS?");
    w = *part;
  }
  ImpossibleHeights impossible;
  std::optional<HeightFile> out = heights_in(file, o, w, [&](double, double, double v) { impossible.add(v); });
  if (!out)
    throw core::Error("no pixel of the area has a height", file.string(),
                      impossible.count ? sentence_of(impossible, file) : "is it of this place?");
  return std::move(*out);
}

std::optional<HeightFile> find_heights(const std::filesystem::path& file, const core::Box& within, const OnImpossible& on_impossible) {
  const Opened o = opened(file);
  const std::optional<PixelWindow> w = window_in(o, within);
  return w ? heights_in(file, o, *w, on_impossible) : std::nullopt;
}

}  // namespace swath::io
