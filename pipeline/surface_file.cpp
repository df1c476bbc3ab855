// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/surface_file.h"

#include "io/raster/geotiff.h"
#include "io/raster/height_file.h"

namespace swath::pipeline {

SurfaceFile read_surface(const std::filesystem::path& file, const std::optional<core::Lattice>& window,
                         const io::OnImpossible& on_impossible) {
  SurfaceFile out{io::read_grid(file, window, on_impossible), {}, io::height_unit_of(file)};
  const io::RasterInfo info = io::read_raster_info(file);
  if (!info.crs_wkt.empty()) out.crs = core::Crs(info.crs_wkt);
  std::filesystem::path beside = file;
  beside.replace_filename(file.stem().string() + "_quality" + file.extension().string());
  if (out.grid.sigma.empty() && std::filesystem::exists(beside)) out.grid.sigma = io::read_grid(beside, out.grid.lattice).sigma;
  return out;
}

}  // namespace swath::pipeline
