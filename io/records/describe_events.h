// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/config/value.h"
#include "io/survey/navigation.h"

namespace swath::io {

/// What `describe_file` reports of events in the format of a receiver or camera: number, times, usual interval, sigmas, `warnings`.
core::Value describe_events(const std::filesystem::path& file, EventFormat format);

/// True where the first lines are those of ntpd's loopstats: day, second, offset, frequency, jitter, wander, poll.
bool looks_like_loopstats(const std::filesystem::path& file);
/// Records, times, offsets and jitter of a loopstats log, `warnings`.
core::Value describe_loopstats(const std::filesystem::path& file);

/// Instrument, targets, stations, points and observations of a hangar survey, `warnings` (what makes it unreadable).
core::Value describe_hangar(const std::filesystem::path& file);

}  // namespace swath::io
