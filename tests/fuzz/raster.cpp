// SPDX-License-Identifier: GPL-3.0-or-later
// Rasters behind GDAL: GeoTIFF, ASCII grids, virtual rasters. GDAL itself reports no coverage.
#include "io/raster/geotiff.h"
#include "io/survey/info.h"
#include "io/vector/side_files.h"
#include "tests/fuzz/target.h"

using namespace swath;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string start(reinterpret_cast<const char*>(data), std::min<std::size_t>(size, 4));
  const auto file = fuzz::given(start.starts_with("<") ? "dtm.vrt" : start.starts_with("nc") ? "dtm.asc" : "dtm.tif", data, size);
  fuzz::reading([&] {
    const io::RasterInfo info = io::read_raster_info(file);
    const core::Lattice lattice = io::lattice_of(info, file);
    fuzz::expect(lattice.cell, 1e300, "a cell");
    if (static_cast<double>(info.nx) * info.ny > 1e6) return;
    core::Grid grid = io::read_grid(file);
    for (const float z : grid.height)
      if (z == z) fuzz::expect(z, 3.5e38, "a height");
  });
  fuzz::reading([&] {
    const io::RasterInfo info = io::read_raster_info(file);
    if (static_cast<double>(info.nx) * info.ny <= 1e6) io::read_raster(file);
  });
  fuzz::reading([&] { io::side_files(file); });
  std::filesystem::remove(file);
  return 0;
}
