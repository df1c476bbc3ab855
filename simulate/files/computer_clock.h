// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "simulate/navigation_options.h"

namespace swath::simulate {

/// A computer's clock that NTP pulls to UTC: linear between the updates of its loop, so that it can be inverted exactly.
class ComputerClock {
 public:
  /// The log begins `before` the flight and goes on to one update past its end; times in seconds from the start of the flight.
  ComputerClock(const ClockOptions& options, double duration, std::int64_t seed);

  /// Computer clock minus UTC, s.
  double offset(double t) const;

  /// One update of the loop, as ntpd logs it.
  struct Update {
    double t;          ///< true instant, s
    double clock;      ///< true clock minus UTC, s
    double offset;     ///< measured: reference minus clock, s
    double frequency;  ///< correction that the loop holds, 1 (positive: it speeds the clock up)
    double jitter;     ///< running rms of differences of successive offsets, s
    double wander;     ///< running rms of changes of the frequency, 1
  };
  const std::vector<Update>& updates() const { return updates_; }

 private:
  double begin_, poll_;
  std::vector<Update> updates_;
};

}  // namespace swath::simulate
