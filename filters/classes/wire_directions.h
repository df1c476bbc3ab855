// SPDX-License-Identifier: GPL-3.0-or-later
// Directions in which several neighbours of a point lie in line with it, a vote by bits that replaces most tests of pairs; and what lies
// beside a line.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace swath::filters {

/// Counts by direction (azimuth of half a turn and slope) how many neighbours lie within `near` (m) of the line through the origin. Bins
/// that a neighbour touches count it whole: no line with enough neighbours is missed, some without are kept.
class WireDirections {
 public:
  static constexpr int slopes = 16, azimuths = 64;  ///< bins
  struct Batch;

  /// Lines no steeper than `steepest` (rise / run) with at least three other neighbours of which one is at least `far` (m) away in plan.
  WireDirections(float near, float steepest, float far) : near_(near), steepest_(steepest), far_(far) {}

  void clear();
  /// `n` neighbours at x, y, z from the point, m; writes the bins of the directions to them.
  void add(const float* x, const float* y, const float* z, std::size_t n, std::uint16_t* bin);
  /// Are there enough neighbours in any direction?
  bool any() const;
  /// ... in this bin?
  bool holds(std::uint16_t bin) const { return (fours_[bin / azimuths] & reach_[bin / azimuths]) >> bin % azimuths & 1u; }

 private:
  using Word = std::uint64_t;  ///< one bit for each bin of azimuth
  static Word bits(int first, int last);
  std::uint16_t add(const Batch& b, std::size_t k);
  void vote(Word azimuths, int lowest, int highest, bool is_far);  ///< bins of slope

  float near_, steepest_, far_;
  std::array<Word, slopes> ones_{}, twos_{}, fours_{}, reach_{};  ///< counts of neighbours in binary, ending at four; of far ones
};

constexpr double clear_tube = 1.5;  // m around the line
constexpr double cross_cell = 0.5;  // m, raster of the tube's cross-section

/// Cells of a line's cross-section that hold points, within the tube.
class CrossSection {
 public:
  void add(double v, double w) {
    const auto at = [](double d) { return static_cast<unsigned>(std::floor((d + clear_tube) / cross_cell)); };
    taken_ |= std::uint64_t{1} << (at(v) * across + at(w));
  }
  std::size_t taken() const { return static_cast<std::size_t>(std::popcount(taken_)); }

 private:
  static constexpr unsigned across = 7;  // the tube's width and its rim
  static_assert(across >= 2.0 * clear_tube / cross_cell + 1.0 && across * across <= 64);
  std::uint64_t taken_ = 0;
};

}  // namespace swath::filters
