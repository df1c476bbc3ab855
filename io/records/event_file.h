// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/records/clock_data.h"
#include "core/records/event_data.h"
#include "core/report.h"
#include "io/survey/survey.h"

namespace swath::io {

/// Reads one file of events, text or a receiver's or camera's own (event_marks.h): times by the file's scale, ids as text, strips. Times
/// that fall or repeat are kept as they are and counted. Latency is not applied yet. Times of a computer's clock are given in the count of
/// GPS. Throws Error "file:line" for a line that cannot be read.
core::EventTags read_event_file(const Survey& survey, const EventFile& file, core::Tally& tally);

/// As the file's entry states it, else the file's name without its ending.
std::string technique_of(const EventFile& file);

/// Every [[event]] file of the survey, in its order. Throws Error where there is none. Those with `computer_clock` wait for the clock's
/// model (trajectory/clock/clock_model.h).
std::vector<core::EventTags> read_event_files(const Survey& survey, core::Tally& tally);

/// The events of all techniques, latency applied, as GPS time: in the order of the files. Throws Error where one is still by a computer's
/// clock.
core::EventData events_of(const std::vector<core::EventTags>& techniques);

}  // namespace swath::io
