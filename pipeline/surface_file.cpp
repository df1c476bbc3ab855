// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/surface_file.h"

#include <string>

#include "io/raster/geotiff.h"

namespace swath::pipeline {

double height_unit_of(const std::filesystem::path& file) {
  const io::RasterInfo info = io::read_raster_info(file);
  const std::string unit = info.units.empty() ? "" : info.units[0];
  if (unit == "m" || unit == "metre" || unit == "meter") return 1.0;
  if (unit == "ft" || unit == "foot") return 0.3048;
  if (unit == "US survey foot" || unit == "ftUS" || unit == "us-ft") return 1200.0 / 3937.0;
  return info.crs_wkt.empty() ? 1.0 : core::Crs(info.crs_wkt).vertical_metres_per_unit();
}

SurfaceFile read_surface(const std::filesystem::path& file, const std::optional<core::Lattice>& window) {
  SurfaceFile out{io::read_grid(file, window), {}, height_unit_of(file)};
  const io::RasterInfo info = io::read_raster_info(file);
  if (!info.crs_wkt.empty()) out.crs = core::Crs(info.crs_wkt);
  std::filesystem::path beside = file;
  beside.replace_filename(file.stem().string() + "_quality" + file.extension().string());
  if (out.grid.sigma.empty() && std::filesystem::exists(beside)) out.grid.sigma = io::read_grid(beside, out.grid.lattice).sigma;
  return out;
}

}  // namespace swath::pipeline
