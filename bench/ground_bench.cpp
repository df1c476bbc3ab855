// SPDX-License-Identifier: GPL-3.0-or-later
// Returns per processor second of filters.ground on one tile: ground_bench EAST NORTH SIDE < POINTS. In: six doubles per point, as for
// ground_evidence. The tile's south-west corner is at EAST, NORTH; points within the halo around it are taken, those beyond left out.
#ifdef __linux__
#include <malloc.h>
#endif

#include <array>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

#include "bench/timing.h"
#include "filters/ground/ground.h"

int main(int argc, char** argv) {
  using namespace swath;
  if (argc < 4) return 1;
  const double east = std::atof(argv[1]), north = std::atof(argv[2]), side = std::atof(argv[3]);
  const filters::GroundOptions options;
  const double halo = argc > 4 ? std::atof(argv[4]) : filters::halo(options);
  core::Block own, around;
  for (core::Block* b : {&own, &around}) {
    core::add_columns(*b, {core::Column::return_number, core::Column::return_count, core::Column::flags, core::Column::strip});
    b->origin = {east, north, 0.0};
  }
  for (std::array<double, 6> row{}; std::fread(row.data(), sizeof row, 1, stdin) == 1;) {
    const double x = row[0] - east, y = row[1] - north;
    if (x < -halo || y < -halo || x >= side + halo || y >= side + halo) continue;
    core::Block& b = x >= 0 && y >= 0 && x < side && y < side ? own : around;
    b.x.push_back(x), b.y.push_back(y), b.z.push_back(row[2]);
    b.return_number.push_back(static_cast<std::uint8_t>(row[3]));
    b.return_count.push_back(static_cast<std::uint8_t>(row[4]));
    b.flags.push_back(0);
    b.strip.push_back(static_cast<std::uint16_t>(row[5]));
  }
  const size_t mine = own.size();
  core::append(own, around);
#ifdef __linux__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // as the program has it
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
#endif
  std::vector<double> took;
  filters::GroundChances n;
  for (int round = 0; round < 3; ++round) {
    const double began = bench::processor_seconds();
    n = filters::classify_ground(own, mine, options);
    took.push_back(bench::processor_seconds() - began);
  }
  std::printf("filters.ground: %zu returns of %zu, halo %.0f m: %.2f s, %.3f M returns/s; ground %llu, doubtful %llu\n", mine, own.size(),
              halo, bench::median(took), static_cast<double>(mine) / bench::median(took) / 1e6, static_cast<unsigned long long>(n.ground),
              static_cast<unsigned long long>(n.doubtful));
  if (const char* to = std::getenv("OUT")) {
    std::FILE* f = std::fopen(to, "wb");
    std::fwrite(own.ground_probability.data(), sizeof(float), mine, f);
    std::fclose(f);
  }
}
