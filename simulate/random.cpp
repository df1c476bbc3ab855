// SPDX-License-Identifier: GPL-3.0-or-later
// SplitMix64 after Steele, Lea, Flood 2014 (finalizer: variant 13 of Stafford's mixers), normals after Box and Muller 1958.
#include "simulate/random.h"

#include <cmath>
#include <numbers>

namespace swath::simulate {
namespace {

constexpr std::uint64_t golden = 0x9e3779b97f4a7c15ULL;

std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t stream, std::uint64_t index)
    : state_(mix(mix(mix(seed + golden) + (stream + 1) * golden) + (index + 1) * golden)) {}

std::uint64_t Random::bits() {
  state_ += golden;
  return mix(state_);
}

double Random::uniform() { return (static_cast<double>(bits() >> 11) + 0.5) * 0x1.0p-53; }

double Random::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double r = std::sqrt(-2.0 * std::log(uniform()));
  const double angle = 2.0 * std::numbers::pi * uniform();
  spare_ = r * std::sin(angle);
  has_spare_ = true;
  return r * std::cos(angle);
}

double Random::exponential() { return -std::log(uniform()); }

int Random::poisson(double mean) {
  if (mean > 50.0) return static_cast<int>(std::lround(std::fmax(0.0, mean + std::sqrt(mean) * normal())));
  const double limit = std::exp(-mean);
  int n = 0;
  for (double p = uniform(); p > limit; p *= uniform()) ++n;
  return n;
}

void GaussMarkov::advance(double step) {
  const double phi = std::exp(-step / correlation_);
  value_ = phi * value_ + std::sqrt(-std::expm1(-2 * step / correlation_)) * random_.normal();
}

}  // namespace swath::simulate
