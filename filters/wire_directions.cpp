// SPDX-License-Identifier: GPL-3.0-or-later
// A Hough transform of lines through one point, its counters kept as bits of words so that one neighbour votes for 64 azimuths at once.
#include "filters/wire_directions.h"

#include <algorithm>
#include <cmath>

namespace swath::filters {
namespace {

constexpr float safety = 1e-4f;    // of rounding
constexpr float widening = 1.05f;  // of near / distance over its arc sine where that is at most a quarter of a turn's sixth

/// Grows evenly enough with the azimuth of (x, y), y >= 0, from 0 to 2 over half a turn: by 0.5 to 1 per radian.
float diamond(float x, float y) { return x >= 0.0f ? y / (x + y) : 2.0f - y / (y - x); }

}  // namespace

/// Those from `first` to `last` inclusive, cut to those of a word.
WireDirections::Word WireDirections::bits(int first, int last) {
  first = std::max(first, 0), last = std::min(last, azimuths - 1);
  if (first > last) return 0;
  return (~Word{0} >> (azimuths - 1 - last)) & (~Word{0} << first);
}

void WireDirections::clear() { ones_.fill(0), twos_.fill(0), fours_.fill(0), reach_.fill(0); }

int WireDirections::slope_bin(float slope) const {
  const float at = (slope + steepest_) / (2.0f * steepest_) * static_cast<float>(slopes);
  return static_cast<int>(std::floor(std::clamp(at, -1.0f, static_cast<float>(slopes))));
}

void WireDirections::vote(Word which, float lowest, float highest, bool is_far) {
  const int first = std::max(slope_bin(lowest), 0), last = std::min(slope_bin(highest), slopes - 1);
  for (int s = first; s <= last; ++s) {
    const auto k = static_cast<size_t>(s);
    const Word carry = ones_[k] & which, carry2 = twos_[k] & carry;
    ones_[k] ^= which;
    twos_[k] ^= carry;
    fours_[k] |= carry2;
    if (is_far) reach_[k] |= which;
  }
}

std::uint16_t WireDirections::add(float x, float y, float z) {
  const float r = std::sqrt(x * x + y * y);
  if (y < 0.0f) x = -x, y = -y, z = -z;
  if (r <= 2.0f * near_) {  // near lines of nearly all azimuths: count it for all of them
    const float flat = std::max(std::abs(z) - near_, 0.0f);
    if (flat <= steepest_ * r) vote(~Word{0}, -steepest_, steepest_, false);
    return 0;
  }
  const float shortest = std::sqrt(r * r - near_ * near_);
  const float lowest = std::min((z - near_) / r, (z - near_) / shortest) - safety;
  const float highest = std::max((z + near_) / r, (z + near_) / shortest) + safety;
  if (lowest > steepest_ || highest < -steepest_) return 0;
  constexpr float per_bin = 2.0f / azimuths;
  const float middle = diamond(x, y), wide = widening * near_ / r + safety;
  const int first = static_cast<int>(std::floor((middle - wide) / per_bin)), last = static_cast<int>(std::floor((middle + wide) / per_bin));
  vote(bits(first, last), lowest, highest, r >= far_);
  // Past either end of the half turn a line's direction, and with it its slope, is reversed.
  const Word wrapped = bits(first + azimuths, azimuths - 1) | bits(0, last - azimuths);
  if (wrapped != 0) vote(wrapped, -highest, -lowest, r >= far_);
  const int azimuth = std::clamp(static_cast<int>(std::floor(middle / per_bin)), 0, azimuths - 1);
  return static_cast<std::uint16_t>(std::clamp(slope_bin(z / r), 0, slopes - 1) * azimuths + azimuth);
}

bool WireDirections::any() const {
  Word all = 0;
  for (size_t s = 0; s < slopes; ++s) all |= fours_[s] & reach_[s];
  return all != 0;
}

}  // namespace swath::filters
