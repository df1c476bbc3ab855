// SPDX-License-Identifier: GPL-3.0-or-later
// Ground points per second of terrain.dtm, one thread and two, each with its own tile of a made survey: hills at 8 points per square metre
// in scan lines, halo included; with the defaults and without smoothing. Prints the median of the rounds, by the clock and by the threads'
// own processor time, which holds where other programs share the cores.
#ifdef __linux__
#include <malloc.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <thread>
#include <vector>

#include "bench/timing.h"
#include "terrain/dtm.h"

namespace {

using namespace swath;
using namespace bench;

constexpr double side = 500.0, density = 8.0;

/// A tile with its halo; coordinates on whole millimetres as LAS holds them. `own`: the points within the tile.
core::Block tile(double halo, unsigned seed, size_t& own) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, 0.03);
  const double width = side + 2.0 * halo;
  core::Block b;
  own = 0;
  const auto lines = static_cast<size_t>(width * std::sqrt(density));
  const auto millimetres = [](double v) { return std::round(v * 1e3) / 1e3; };
  for (size_t n = 0; n < lines * lines; ++n) {
    const size_t line = n / lines, along = line % 2 == 0 ? n % lines : lines - 1 - n % lines;
    const double x = millimetres((static_cast<double>(along) + part(random)) / std::sqrt(density) - halo);
    const double y = millimetres((static_cast<double>(line) + part(random)) / std::sqrt(density) - halo);
    own += x >= 0 && x < side && y >= 0 && y < side;
    b.x.push_back(x);
    b.y.push_back(y);
    b.z.push_back(millimetres(20.0 * std::sin(x / 90.0) * std::cos(y / 120.0) + noise(random)));
  }
  b.classification.assign(b.size(), core::point_class::ground);
  b.sigma_v.assign(b.size(), 0.05f);
  b.sigma_h.assign(b.size(), 0.1f);
  return b;
}

}  // namespace

int main(int argc, char** argv) {
#ifdef __linux__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // as the program has it
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
#endif
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  const core::Lattice window{1.0, 0, 0, static_cast<int>(side), static_cast<int>(side)};
  size_t own[2];
  const terrain::DtmOptions defaults;
  terrain::DtmOptions exact;
  exact.smoothing = core::Metres(0.0);
  const core::Block tiles[2] = {tile(terrain::halo(defaults), 1, own[0]), tile(terrain::halo(defaults), 2, own[1])};
  for (const terrain::DtmOptions& options : {defaults, exact})
    for (const int threads : {1, 2}) {
      std::vector<double> rate, processor_rate;
      for (int round = 0; round < rounds; ++round) {
        const auto start = Clock::now();
        std::vector<double> used(static_cast<size_t>(threads));
        std::vector<std::thread> crew;
        double points = 0.0;
        for (size_t k = 0; k < used.size(); ++k) {
          points += static_cast<double>(own[k]);
          crew.emplace_back([&, k] {
            const double began = processor_seconds();
            terrain::dtm(tiles[k], window, options);
            used[k] = processor_seconds() - began;
          });
        }
        for (std::thread& t : crew) t.join();
        rate.push_back(points / seconds(start));
        processor_rate.push_back(points / *std::max_element(used.begin(), used.end()));
      }
      std::printf("terrain.dtm, smoothing %.1f m, %d thread%s: %.2f M ground points/s, %.2f by processor time (%zu own of %zu)\n",
                  options.smoothing.value, threads, threads == 1 ? "" : "s", median(rate) / 1e6, median(processor_rate) / 1e6, own[0],
                  tiles[0].size());
    }
}
