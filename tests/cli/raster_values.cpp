// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the first band of a raster to standard output: int32 columns and rows, float64 west, pixel width, north, pixel height
// (negative), then float64 values row by row from the north; NaN where there is none.
#include <cstdio>
#include <exception>

#include "io/raster/geotiff.h"

int main(int argc, char** argv) {
  try {
    if (argc != 2) return 2;
    const swath::io::Raster r = swath::io::read_raster(argv[1]);
    const int size[2] = {r.nx, r.ny};
    const double place[4] = {r.geotransform[0], r.geotransform[1], r.geotransform[3], r.geotransform[5]};
    std::fwrite(size, sizeof size, 1, stdout);
    std::fwrite(place, sizeof place, 1, stdout);
    std::fwrite(r.values.data(), sizeof(double), r.values.size(), stdout);
    return std::fflush(stdout) == 0 ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
