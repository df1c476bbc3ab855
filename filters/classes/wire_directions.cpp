// SPDX-License-Identifier: GPL-3.0-or-later
// A Hough transform of lines through one point, its counters kept as bits of words so that one neighbour votes for 64 azimuths at once.
#include "filters/classes/wire_directions.h"

#include <algorithm>
#include <cmath>

#include "core/wide.h"

namespace swath::filters {
namespace {

constexpr float safety = 1e-4f;    // of rounding
constexpr float widening = 1.05f;  // of near / distance over its arc sine where that is at most a quarter of a turn's sixth

/// Grows evenly enough with the azimuth of (x, y), y >= 0, from 0 to 2 over half a turn: by 0.5 to 1 per radian.
inline float diamond(float x, float y) {
  const float part = y / (std::abs(x) + y);
  return x >= 0.0f ? part : 2.0f - part;
}

constexpr std::size_t batch_size = 32;
constexpr float least_run = 1e-6f;  // m: what is so near is not asked for its direction

inline int slope_bin(float slope, float steepest) {
  const float at = (slope + steepest) / (2.0f * steepest) * static_cast<float>(WireDirections::slopes);
  const float least = at < -1.0f ? -1.0f : at;
  return static_cast<int>(
      std::floor(least > static_cast<float>(WireDirections::slopes) ? static_cast<float>(WireDirections::slopes) : least));
}

}  // namespace

/// Of a few neighbours at once: what their votes are.
struct WireDirections::Batch {
  float run[batch_size], flat[batch_size];        ///< m in plan; m in height beside which they lie near the line of any azimuth
  float lowest[batch_size], highest[batch_size];  ///< slopes of the lines near them
  std::int32_t low[batch_size], high[batch_size], first[batch_size], last[batch_size];  ///< the same in bins; bins of azimuth
  std::int32_t slope[batch_size], azimuth[batch_size];                                  ///< bins of the direction to them
};

namespace {

SWATH_WIDE void measure(const float* px, const float* py, const float* pz, std::size_t n, float near, float steepest,
                        WireDirections::Batch& b) {
  constexpr float per_bin = 2.0f / WireDirections::azimuths;
  for (std::size_t k = 0; k < n; ++k) {
    const bool turned = py[k] < 0.0f;
    const float x = turned ? -px[k] : px[k], y = turned ? -py[k] : py[k], z = turned ? -pz[k] : pz[k];
    const float r = std::max(std::sqrt(x * x + y * y), least_run), shortest = std::sqrt(std::max(r * r - near * near, least_run));
    const float flat = std::abs(z) - near;
    const float under = (z - near) / r, under2 = (z - near) / shortest, over = (z + near) / r, over2 = (z + near) / shortest;
    const float lowest = (under2 < under ? under2 : under) - safety, highest = (over2 > over ? over2 : over) + safety;
    const float middle = diamond(x, y), wide = widening * near / r + safety;
    b.run[k] = r, b.flat[k] = flat > 0.0f ? flat : 0.0f;
    b.lowest[k] = lowest, b.highest[k] = highest;
    b.low[k] = slope_bin(lowest, steepest), b.high[k] = slope_bin(highest, steepest);
    b.first[k] = static_cast<std::int32_t>(std::floor((middle - wide) / per_bin));
    b.last[k] = static_cast<std::int32_t>(std::floor((middle + wide) / per_bin));
    b.slope[k] = slope_bin(z / r, steepest), b.azimuth[k] = static_cast<std::int32_t>(std::floor(middle / per_bin));
  }
}

}  // namespace

/// Those from `first` to `last` inclusive, cut to those of a word.
WireDirections::Word WireDirections::bits(int first, int last) {
  first = std::max(first, 0), last = std::min(last, azimuths - 1);
  if (first > last) return 0;
  return (~Word{0} >> (azimuths - 1 - last)) & (~Word{0} << first);
}

void WireDirections::clear() { ones_.fill(0), twos_.fill(0), fours_.fill(0), reach_.fill(0); }

void WireDirections::vote(Word which, int lowest, int highest, bool is_far) {
  const int first = std::max(lowest, 0), last = std::min(highest, slopes - 1);
  for (int s = first; s <= last; ++s) {
    const auto k = static_cast<size_t>(s);
    const Word carry = ones_[k] & which, carry2 = twos_[k] & carry;
    ones_[k] ^= which;
    twos_[k] ^= carry;
    fours_[k] |= carry2;
    if (is_far) reach_[k] |= which;
  }
}

void WireDirections::add(const float* x, const float* y, const float* z, std::size_t n, std::uint16_t* bin) {
  Batch batch;
  for (std::size_t from = 0; from < n; from += batch_size) {
    const std::size_t many = std::min(batch_size, n - from);
    measure(x + from, y + from, z + from, many, near_, steepest_, batch);
    for (std::size_t k = 0; k < many; ++k) bin[from + k] = add(batch, k);
  }
}

std::uint16_t WireDirections::add(const Batch& b, std::size_t k) {
  const float r = b.run[k];
  if (r <= 2.0f * near_) {  // near lines of nearly all azimuths: count it for all of them
    if (b.flat[k] <= steepest_ * r) vote(~Word{0}, 0, slopes - 1, false);
    return 0;
  }
  if (b.lowest[k] > steepest_ || b.highest[k] < -steepest_) return 0;
  vote(bits(b.first[k], b.last[k]), b.low[k], b.high[k], r >= far_);
  // Past either end of the half turn a line's direction, and with it its slope, is reversed.
  if (b.last[k] >= azimuths || b.first[k] < 0)
    vote(bits(b.first[k] + azimuths, azimuths - 1) | bits(0, b.last[k] - azimuths), slope_bin(-b.highest[k], steepest_),
         slope_bin(-b.lowest[k], steepest_), r >= far_);
  return static_cast<std::uint16_t>(std::clamp(b.slope[k], 0, slopes - 1) * azimuths + std::clamp(b.azimuth[k], 0, azimuths - 1));
}

bool WireDirections::any() const {
  Word all = 0;
  for (size_t s = 0; s < slopes; ++s) all |= fours_[s] & reach_[s];
  return all != 0;
}

}  // namespace swath::filters
