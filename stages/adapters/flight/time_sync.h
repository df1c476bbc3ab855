// SPDX-License-Identifier: GPL-3.0-or-later
// The events of a flight on GPS time.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/config/result.h"
#include "stages/once.h"
#include "trajectory/clock/techniques.h"

namespace swath::stages {

struct TimeSyncOptions : trajectory::TechniqueOptions {
  std::string technique;
  std::string file = "events_time.csv";
};

template <class V>
void describe(TimeSyncOptions& o, V& v) {
  describe(static_cast<trajectory::TechniqueOptions&>(o), v);
  v.option("technique", o.technique, "Technique whose events are handed on; empty: all.");
  v.option("file", o.file, "Name of the table of events within the output.");
}

struct TimeSyncFindings {
  std::optional<trajectory::ClockFigures> clock{};
  std::vector<trajectory::TechniqueFigures> events{};
  std::vector<trajectory::TechniqueDifferences> comparisons{};
};

template <class V>
void describe(const TimeSyncFindings& r, V& v) {
  v.table("clock", r.clock, "The log of the computer's clock.");
  v.tables("events", r.events, "Events by technique.");
  v.tables_if(!r.comparisons.empty(), "comparisons", r.comparisons, "Techniques against one another.");
}

Given<core::EventData, TimeSyncFindings> sync_times(const io::Survey& survey, const trajectory::Trajectory* flown, const TimeSyncOptions& o,
                                                    const Output& to, core::Tally& tally);
void expect_events(const Context& context, const TimeSyncOptions& o);
std::vector<std::filesystem::path> event_files(const io::Survey& survey);
std::vector<std::string> time_sync_products(const TimeSyncOptions& o);

}  // namespace swath::stages
