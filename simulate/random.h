// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace swath::simulate {

/// Random numbers that depend on (seed, stream, index) alone: each pulse has its own short sequence, so that results do not
/// depend on the order or the number of threads. SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number
/// generators", fig. 17), its start made from the three numbers by its own finalizer.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream, std::uint64_t index);

  std::uint64_t bits();
  /// In (0, 1), 53 bits.
  double uniform();
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Mean 0, sigma 1 (Box and Muller 1958).
  double normal();
  /// Mean 1.
  double exponential();
  /// Mean `mean`; meant for means below some hundreds (Knuth's product method, normal form above 50).
  int poisson(double mean);

 private:
  std::uint64_t state_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

/// The streams of one seed.
enum class Stream : std::uint64_t {
  relief,
  buildings,
  trees,
  wires,
  turbulence,
  trajectory,
  calibration,
  pulse,
  noise,
  inertial,
  gnss,
  imu_drift,
  gnss_drift,
  gnss_sky,
  gnss_outlier,
  gnss_velocity,
  clock,
  events,
  mounting,
  line_errors,
  control,
  structures,
  fields,
  low_groups,
  camera
};

inline Random random_of(std::int64_t seed, Stream stream, std::uint64_t index = 0) {
  return Random(static_cast<std::uint64_t>(seed), static_cast<std::uint64_t>(stream), index);
}

/// First-order Gauss-Markov process of sigma 1, stationary from its first value, exact at any steps:
/// x(t + step) = phi x(t) + sqrt(1 - phi^2) n, phi = exp(-step / correlation).
class GaussMarkov {
 public:
  GaussMarkov(double correlation, Random random) : correlation_(correlation), random_(random), value_(random_.normal()) {}
  double value() const { return value_; }
  void advance(double step);

 private:
  double correlation_;
  Random random_;
  double value_;
};

}  // namespace swath::simulate
