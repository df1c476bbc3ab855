// SPDX-License-Identifier: GPL-3.0-or-later
// Returns per second of filters.outlier on one thread and on two, each with its own tile of a made survey: hills at 8 returns per square
// metre, a quarter of it under trees, halo included. Prints the median of the rounds.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <thread>
#include <vector>

#include "filters/outlier.h"

namespace {

using namespace swath;
using Clock = std::chrono::steady_clock;

constexpr double side = 500.0, density = 8.0;

/// A tile and its halo; own points first. `own`: their number.
core::Block tile(double halo, unsigned seed, size_t& own) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-halo, side + halo), part(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, 0.03);
  const double width = side + 2.0 * halo;
  core::Block inner, outer;
  const auto pulses = static_cast<size_t>(density * width * width);
  for (size_t n = 0; n < pulses; ++n) {
    const double x = place(random), y = place(random);
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

double seconds(Clock::time_point from) { return std::chrono::duration<double>(Clock::now() - from).count(); }

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  const filters::OutlierOptions options;
  size_t own[2];
  const core::Block tiles[2] = {tile(filters::halo(options), 1, own[0]), tile(filters::halo(options), 2, own[1])};
  for (const int threads : {1, 2}) {
    std::vector<double> rate;
    filters::OutlierCounts counts;
    for (int round = 0; round < rounds; ++round) {
      std::vector<core::Block> work(tiles, tiles + threads);
      const auto start = Clock::now();
      std::vector<std::thread> crew;
      size_t returns = 0;
      for (size_t k = 0; k < work.size(); ++k) {
        returns += own[k];
        crew.emplace_back([&, k] {
          const filters::OutlierCounts n = filters::flag_outliers(work[k], own[k], options);
          if (k == 0) counts = n;
        });
      }
      for (std::thread& t : crew) t.join();
      rate.push_back(static_cast<double>(returns) / seconds(start));
    }
    std::printf("filters.outlier, %d thread%s: %.2f M returns/s of the tile's own (%zu own of %zu); outliers %llu\n", threads,
                threads == 1 ? "" : "s", median(rate) / 1e6, own[0], tiles[0].size(),
                static_cast<unsigned long long>(counts.low_noise + counts.high_noise));
  }
}
