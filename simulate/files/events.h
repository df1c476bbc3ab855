// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/time.h"
#include "io/survey/navigation.h"
#include "simulate/flight.h"
#include "simulate/navigation_options.h"

namespace swath::simulate {

/// One exposure.
struct Event {
  int id, line;
  double t;  ///< true instant, seconds from the start of the flight
};

/// Exposures along each line, `interval` apart give or take 2 % of it; ids from 1.
std::vector<Event> plan_events(const Flight& flight, const EventOptions& options, std::int64_t seed);

/// UTC by day and second, exact to the rounding of a second of day.
struct UtcDay {
  std::int64_t mjd;  ///< modified Julian date
  double second;     ///< of that day
};
/// The instant `t` seconds after `start`; a clock that stands wrong by `offset` reads that much more.
UtcDay utc_day(core::GpsTime start, double t, double offset = 0.0);

/// Files of a flight's events:
///   events_pc.csv     id, strip, UTC second of day by the computer's clock
///   events_marks.csv  id, strip, GPS seconds of week by the receiver's event marks
///   loopstats         ntpd's log: MJD, second of day, offset (reference - clock, s), frequency (ppm), jitter (s), wander (ppm), poll (log2
///   s) pps.log           MJD and second of day by the computer's clock of each pulse, which comes with the whole second of UTC
///   truth/events.csv  true instants, computer clock minus UTC, poses
/// Noise-free: no noise of tags and marks, an NTP without jitter and wander; offset and frequency of the clock stay.
/// Returns the number of events. Folders must exist.
std::int64_t write_events(const std::filesystem::path& folder, const Flight& flight, core::GpsTime start, const EventOptions& options,
                          bool noise_free, std::int64_t seed);

/// What survey.toml says of them: one log is named, the loopstats; pps.log is another view of the same clock.
std::vector<io::ClockLog> describe_clocks();
std::vector<io::EventFile> describe_events(const Flight& flight, core::GpsTime start, const EventOptions& options, std::int64_t seed);

}  // namespace swath::simulate
