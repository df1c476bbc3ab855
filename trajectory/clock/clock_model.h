// SPDX-License-Identifier: GPL-3.0-or-later
// A computer's clock against GPS time: events that it timed are brought to GPS time by the log of its offset.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "core/config/option.h"
#include "core/records/clock_data.h"
#include "trajectory/clock/clock_parts.h"

namespace swath::trajectory {

enum class ClockMethod { literal, robust };
enum class Convergence { detect, fixed, none };

struct ClockOptions {
  ClockMethod model = ClockMethod::robust;
  Convergence convergence = Convergence::detect;
  core::Seconds convergence_time{1000.0};
  double settled_factor = 4.0;
  core::Seconds max_gap{600.0};
  core::Seconds tag_sigma{5e-6};
};

template <class V>
void describe(ClockOptions& o, V& v) {
  v.option("model", o.model, "literal: linear between the log's records; robust: smoothed, with sigma, outliers and steps.", "Reis2011");
  v.option("convergence", o.convergence, "detect: settled when offset and jitter have; fixed: after convergence_time; none: at once.");
  v.option("convergence_time", o.convergence_time, core::at_least(0), "Time to settle (convergence fixed).", "Reis2011");
  v.option("settled_factor", o.settled_factor, core::above(1),
           "The clock has settled when its scatter is within this factor of the log's calm part (detect).");
  v.option("max_gap", o.max_gap, core::above(0), "Events between two records of the log farther apart than this are doubtful.");
  v.option("tag_sigma", o.tag_sigma, core::at_least(0),
           "Sigma of the computer's reading of an event (interrupt latency), added to its clock's (robust).");
}

/// The clock at one instant.
struct ClockReading {
  double offset = 0.0;  ///< GPS time - clock (in the count of GPS), s
  double drift = 0.0;   ///< its rate, s/s
  double sigma = 0.0;   ///< of the offset, s; 0 with the literal model: not known
  bool settled = true;
  bool inside = true;  ///< between two records of one stretch that are near enough to each other
};

/// A stretch of the log without a step of the clock.
struct ClockStretch {
  size_t first = 0, last = 0;  ///< records
  double settled = 0.0;        ///< from when on the clock has settled, s since epoch; infinite: never
  double step = 0.0;           ///< jump of the offset before it, s; 0 for the first
};

/// Robust model: offset and drift, both of which walk at random, observed by the log with white errors. The strengths of walks and errors
/// are found from the likelihood of the log in overlapping windows, so that they may change with time; then a Kalman filter and a
/// Rauch-Tung-Striebel smoother over each stretch, errors beyond three sigma down-weighted. Assumes errors of the log that are independent
/// from record to record. Times are s since the log's epoch, by the clock.
class ClockModel {
 public:
  /// Throws core::Error where the log has less than two records or its times do not rise.
  explicit ClockModel(core::ClockData log, const ClockOptions& options = {});

  /// Outside the log the nearest stretch is carried on: `inside` is false and sigma grows.
  ClockReading at(double time) const;

  const core::ClockData& log() const { return log_; }
  const std::vector<ClockStretch>& stretches() const { return stretches_; }
  /// Records of the log that lie beyond six sigma (model robust).
  size_t outliers() const { return outliers_; }
  /// Sigma of the log's records, s (model robust).
  const std::vector<double>& noise() const { return noise_; }

 private:
  void smooth(const ClockStretch& stretch);
  ClockReading read_smooth(const ClockStretch& stretch, double time) const;
  ClockReading read_literal(double time) const;

  core::ClockData log_;
  ClockOptions options_;
  std::vector<ClockStretch> stretches_;
  std::vector<double> noise_;
  std::vector<clock::Walk> walk_;  // from each record to the next
  std::vector<clock::State> filtered_, smoothed_;
  size_t outliers_ = 0;
};

/// Events of one technique on GPS time, latency not applied yet.
struct CorrectedEvents {
  core::EventTags raw, events;
  std::vector<ClockReading> readings;          ///< of the clock at each; empty where it needs none
  size_t before_settled = 0, outside_log = 0;  ///< of these `doubtful` is 1
};

/// Corrects events of the computer's clock.
CorrectedEvents correct(core::EventTags events, const ClockModel& clock, const ClockOptions& options = {});

}  // namespace swath::trajectory

namespace swath::core {
template <>
struct Choices<trajectory::ClockMethod> {
  static constexpr std::array<std::string_view, 2> names{"literal", "robust"};
};
template <>
struct Choices<trajectory::Convergence> {
  static constexpr std::array<std::string_view, 3> names{"detect", "fixed", "none"};
};
}  // namespace swath::core
