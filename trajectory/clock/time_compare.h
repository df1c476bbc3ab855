// SPDX-License-Identifier: GPL-3.0-or-later
// Two techniques that timed the same events: how far are they apart, in seconds and in metres of flight?
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/config/result.h"
#include "core/records/clock_data.h"
#include "trajectory/trajectory.h"

namespace swath::trajectory {

enum class EventMatch {
  id,    ///< events of one name are the same
  time,  ///< each event with the nearest of the other technique that is nearest to it in turn
};

/// One event as both timed it.
struct TimePair {
  size_t first = 0, second = 0;  ///< indices in the two techniques
  double time = 0.0;             ///< by the second technique, s since its epoch
  double difference = 0.0;       ///< first - second, s, latencies included
  double sigma = 0.0;            ///< of the difference, from both; 0: not known
  std::int32_t strip = 0;        ///< of the first, or else of the second
  bool doubtful = false;         ///< by either
};

/// Differences in one unit.
struct Spread {
  size_t n = 0;
  double bias = 0.0;         ///< mean
  double rms = 0.0;          ///< about zero
  double standard = 0.0;     ///< about the mean, n - 1; 0 for n < 2
  double largest = 0.0;      ///< greatest absolute value
  double error_ratio = 0.0;  ///< rms of difference / sigma; 0 where sigmas are not known
};

template <class V>
void describe(const Spread& r, V& v) {
  const auto known = core::plain().always().only_if(r.n > 0);
  v.result("n", r.n, "Pairs.");
  v.result("bias", r.bias, known, "Mean difference.");
  v.result("rms", r.rms, known, "RMS difference.");
  v.result("standard_deviation", r.standard, core::plain().only_if(r.n > 1), "Standard deviation about the mean.");
  v.result("largest", r.largest, known, "Largest absolute difference.");
  v.result("error_over_sigma", r.error_ratio, core::plain(2).only_if(r.error_ratio > 0),
           "RMS of difference / sigma, where sigmas are known.");
}

/// difference = shift + drift (time - time of the first pair), by least squares.
struct ShiftDrift {
  double shift = 0.0;      ///< s
  double drift = 0.0;      ///< s/s
  double rms_after = 0.0;  ///< about the line, n in the denominator, s
};

template <class V>
void describe(const ShiftDrift& r, V& v) {
  v.result("shift_s", r.shift, core::Form{"s"}.always(), "Difference at the first pair.");
  v.result("drift", r.drift, core::Form{"s/s"}.always(), "Its rate.");
  v.result("rms_after_s", r.rms_after, core::Form{"s"}.always(), "RMS about the line.");
}

struct TimeComparison {
  std::vector<TimePair> pairs;             ///< in the first technique's order
  size_t only_first = 0, only_second = 0;  ///< events without a partner
  Spread all, trusted;                     ///< s; trusted: neither doubts the event
};

/// Events of two techniques, pair by pair; the latencies of both are applied. `tolerance`: pairs farther apart are none, s. Names that
/// repeat are paired in their order.
TimeComparison compare(const core::EventTags& first, const core::EventTags& second, EventMatch match, double tolerance);

/// Of differences, s; sigmas as given (0: not known).
Spread spread_of(const std::vector<double>& differences, const std::vector<double>& sigmas = {});

/// Of pairs in time order; `stamps`: the first technique's own times where these are the line's abscissa. Less than two pairs: a shift
/// alone.
ShiftDrift shift_and_drift(const std::vector<TimePair>& pairs, const core::EventTags& first);

/// The differences as places: along the track, to the right of it, up. Pairs outside the trajectory are counted and left out.
struct PlaceComparison {
  std::array<Spread, 3> axes;  ///< along, across, up, m
  Spread length;               ///< of the vectors: bias is their mean length, m
  size_t outside = 0;
  bool is_along_alone = false;  ///< by a stated speed: the others are not known
};

template <class V>
void describe(const PlaceComparison& r, V& v) {
  const auto known = [&r](const Spread& s) { return r.is_along_alone ? std::nullopt : std::optional(s); };
  v.table("along", r.axes[0], "Along the track, m.");
  v.table("across", known(r.axes[1]), "To the right of it, m.");
  v.table("up", known(r.axes[2]), "Up, m.");
  v.table("length", known(r.length), "Length of the vectors, m.");
  v.result("outside_trajectory", r.outside, core::if_any(), "Pairs outside the trajectory.");
}

/// Place of the body by the first technique minus that by the second. The velocity is taken half-way, which leaves the third power of the
/// difference: 10 ms at 100 m/s^3 is 4 um.
PlaceComparison compare_places(const std::vector<TimePair>& pairs, const core::EventTags& second, const Trajectory& trajectory,
                               bool trusted_only = true);
/// The same along the track at one speed, m/s.
PlaceComparison compare_places(const std::vector<TimePair>& pairs, double speed);

}  // namespace swath::trajectory

namespace swath::core {
template <>
struct Choices<trajectory::EventMatch> {
  static constexpr std::array<std::string_view, 2> names{"id", "time"};
};
}  // namespace swath::core
