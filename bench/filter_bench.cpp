// SPDX-License-Identifier: GPL-3.0-or-later
// Returns per second of filters.outlier on one thread and on two, each with its own tile of a made survey: hills at 8 returns per square
// metre in scan lines, a quarter of it under trees, halo included. Prints the median of the rounds, by the clock and by the threads' own
// processor time, which holds where other programs share the cores.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <thread>
#include <vector>

#include "bench/timing.h"
#include "filters/noise/outlier.h"

namespace {

using namespace swath;
using namespace bench;

constexpr double side = 500.0, density = 8.0;

/// A tile and its halo; own points first. `own`: their number.
core::Block tile(double halo, unsigned seed, size_t& own) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, 0.03);
  const double width = side + 2.0 * halo;
  core::Block inner, outer;
  const auto lines = static_cast<size_t>(width * std::sqrt(density));
  for (size_t n = 0; n < lines * lines; ++n) {
    const size_t line = n / lines, along = line % 2 == 0 ? n % lines : lines - 1 - n % lines;
    const double x = (static_cast<double>(along) + part(random)) / std::sqrt(density) - halo;
    const double y = (static_cast<double>(line) + part(random)) / std::sqrt(density) - halo;
    double z = 20.0 * std::sin(x / 90.0) * std::cos(y / 120.0) + noise(random);
    if (std::fmod(x + 1000.0, 200.0) < 50.0 && part(random) < 0.7) z += 4.0 + 14.0 * part(random);
    if (part(random) < 1e-4) z += 60.0 * part(random);
    core::Block& to = x >= 0 && x < side && y >= 0 && y < side ? inner : outer;
    to.x.push_back(x), to.y.push_back(y), to.z.push_back(z);
  }
  own = inner.size();
  core::append(inner, outer);
  return inner;
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  const filters::OutlierOptions options;
  size_t own[2];
  const core::Block tiles[2] = {tile(filters::halo(options), 1, own[0]), tile(filters::halo(options), 2, own[1])};
  for (const int threads : {1, 2}) {
    std::vector<double> rate, processor_rate;
    filters::OutlierCounts counts;
    for (int round = 0; round < rounds; ++round) {
      std::vector<core::Block> work(tiles, tiles + threads);
      const auto start = Clock::now();
      std::vector<std::thread> crew;
      size_t returns = 0;
      for (size_t k = 0; k < work.size(); ++k) {
        returns += own[k];
        crew.emplace_back([&, k] {
          const double began = processor_seconds();
          const filters::OutlierCounts n = filters::flag_outliers(work[k], own[k], options);
          if (k > 0) return;
          counts = n;
          processor_rate.push_back(static_cast<double>(own[k] * work.size()) / (processor_seconds() - began));
        });
      }
      for (std::thread& t : crew) t.join();
      rate.push_back(static_cast<double>(returns) / seconds(start));
    }
    std::printf("filters.outlier, %d thread%s: %.2f M returns/s, %.2f by processor time (%zu own of %zu); outliers %llu\n", threads,
                threads == 1 ? "" : "s", median(rate) / 1e6, median(processor_rate) / 1e6, own[0], tiles[0].size(),
                static_cast<unsigned long long>(counts.low_noise + counts.high_noise));
  }
}
