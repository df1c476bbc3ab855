// SPDX-License-Identifier: GPL-3.0-or-later
// The numerical parts of the clock's model: one stretch of a log without steps.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/records/clock_data.h"

namespace swath::trajectory::clock {

/// Offset (s), drift (s/s), and their covariance: xx, xy, yy.
using State = std::array<double, 5>;

struct Records {
  std::span<const double> time, offset;
  std::vector<double> shape;        ///< sigma of each record up to a common factor
  std::vector<std::uint8_t> spike;  ///< 1: it stands out from the lines on both sides and is no observation

  bool steered = false;  ///< the clock answers to the records' errors

  size_t size() const { return time.size(); }
};

/// Spectral densities of a clock's random walks: of its offset (white noise of frequency, s) and of its drift (1/s).
struct Walk {
  double offset = 0.0, drift = 0.0;
};

/// How restless the clock and its log are. Columns of the records' length.
struct Strengths {
  std::vector<double> noise;  ///< sigma of each record, s
  std::vector<Walk> walk;     ///< from this record to the next
};

struct Pass {
  std::vector<State> filtered, smoothed;
};

double median(std::vector<double> v);
std::vector<double> running_median(std::span<const double> v, size_t width);

/// A straight line through the observations [first, last] by medians: its level at time t, its slope and the slopes' spread.
struct Line {
  double level = 0.0, slope = 0.0, spread = 0.0;
};
Line line_through(std::span<const double> time, std::span<const double> offset, size_t first, size_t last, double t);

/// Lone records far from the lines before and after them, which agree with each other: bad records, not a turn of the clock.
std::vector<std::uint8_t> spikes_of(std::span<const double> time, std::span<const double> offset, const std::vector<double>& scatter);

/// Scatter of the offset about straight lines through neighbours, from second differences, running median; s. Records [first, last].
std::vector<double> scatter_of(const core::ClockData& log, size_t first, size_t last, size_t width);

/// From the likelihood of the innovations in blocks (40 records, more in logs of over 16 000), on a grid of the walks' strengths relative
/// to the noise: the posterior mean of the logarithms, neighbouring blocks being alike but for rare jumps (a hidden Markov chain, its
/// filters interacting at the blocks' borders). Linear in the logarithm between the blocks' middles. Wild innovations have a bounded say:
/// outliers do not make the clock restless.
Strengths strengths_of(const Records& records);

/// Filter and smoother, weights iterated; records beyond six sigma are added to `outliers`.
Pass smoothed(const Records& records, const Strengths& strengths, size_t& outliers);

/// The state dt later or earlier.
State carried(const State& x, double dt, const Walk& walk);
/// One step of Rauch, Tung and Striebel: the filtered state `here` with the smoothed one of dt > 0 later.
State smoothed_back(const State& here, const State& later, double dt, const Walk& walk);

}  // namespace swath::trajectory::clock
