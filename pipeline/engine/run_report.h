// SPDX-License-Identifier: GPL-3.0-or-later
// report.json: what a run says of itself around what its stages declare.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/result.h"
#include "core/report.h"
#include "io/store/address.h"
#include "pipeline/limits.h"
#include "pipeline/provenance.h"
#include "pipeline/work/time_spent.h"

namespace swath::pipeline {

struct CrsReport {
  std::string name, definition, heights;
  std::optional<double> scale{};  ///< of lengths at the data
  double outside = 0.0;           ///< degrees
};

template <class V>
void describe(const CrsReport& r, V& v) {
  v.result("name", r.name, "Its name.");
  v.result("definition", r.definition, "As survey.toml or the cloud states it.");
  v.result("heights", r.heights, "What heights count from.");
  v.result("scale", r.scale.value_or(1.0), core::plain().always().only_if(r.scale.has_value()),
           "Lengths on the map by lengths on the ellipsoid at the data, where they differ most.");
  v.result("degrees_outside", r.outside, core::if_any(), "How far the data lie outside the CRS's area of use.");
}

template <class V>
void describe(const Input& i, V& v) {
  v.result("file", io::shown_name(i.file), "The file.");
  v.result("bytes", i.bytes, "Its length.");
  v.result("xxh3", i.hash, "Its checksum, XXH3 of 64 bits.");
}

struct PointCounts {
  std::uint64_t in = 0, out = 0;
};

template <class V>
void describe(const PointCounts& c, V& v) {
  v.result("in", c.in, "Points or pulses that came in.");
  v.result("out", c.out, "Those that went on.");
}

struct StageReport {
  std::string_view type;
  std::string fingerprint;
  std::optional<PointCounts> counts{};  ///< of stages that work on strips or tiles
  std::uint64_t cut = 0;
  std::vector<core::RecordCount> records{};
  core::Value tally{}, findings{}, options{};
  TimeSpent time{};
};

template <class V>
void describe(const StageReport& s, V& v) {
  v.result("type", s.type, "The stage.");
  v.result("fingerprint", s.fingerprint, "Of the stage, its options, the inputs and the stages before it: equal where the result is.");
  v.table("counts", s.counts, "Points in and out.");
  v.result("tiles_cut_to_fit_memory", s.cut, core::if_any(), "Tiles that were worked on in parts.");
  v.tables_if(!s.records.empty(), "records", s.records, "Records that the stage found in files.");
  v.other("tally", s.tally, "Counts, each with its first examples.");
  v.other("findings", s.findings, "What the stage found.");
  v.other("options", s.options, "Every option: its value, and where it was set.");
  v.result("seconds", s.time.seconds, core::seconds(), "Time of its work, summed over threads.");
  v.result("processor_seconds", s.time.processor, core::seconds(),
           "Processor time of its work, of readers of reading alone; without threads that help with a tile.");
}

struct RunReport {
  std::string program, command, survey;
  std::optional<CrsReport> crs;
  std::vector<Input> inputs;
  core::Value run, geometry, versions;
  std::vector<StageReport> stages;
  std::vector<JudgedLimit> limits;
  std::vector<Warning> warnings;
  std::vector<std::string> control_unused{}, over_memory{};
  std::uint64_t pieces_resumed = 0, pieces_damaged = 0, strips_read_again = 0;
  TimeSpent time{};
  int threads = 0;
};

template <class V>
void describe(const RunReport& r, V& v) {
  v.result("program", r.program, "Program and version.");
  v.result("command", r.command, "The command line.");
  v.result("survey", r.survey, "Name of the survey.");
  v.table("crs", r.crs, "Coordinate reference system of the products; absent where none was needed.");
  v.tables("inputs", r.inputs, "Every file that was read.");
  v.other("run", r.run, "Every option of [run]: its value, and where it was set.");
  v.tables("stages", r.stages, "The stages in their order.");
  v.other("geometry", r.geometry, "What quality.geometry found; absent where it did not run.");
  v.other("versions", r.versions, "Versions of the libraries.");
  v.tables("limits", r.limits, "Limits that [run.limits] sets or the run measured.");
  v.tables("warnings", r.warnings, "What a person should look at.");
  v.result("control_unused", r.control_unused, core::plain().only_if(!r.control_unused.empty()),
           "Files of [[control]] that no stage of the run uses, with what they are for.");
  v.result("over_memory", r.over_memory, core::plain().only_if(!r.over_memory.empty()),
           "Stages estimated to need more than the default of run.memory leaves, with how much.");
  v.result("pieces_resumed", r.pieces_resumed, "Pieces of work that an earlier run had done.");
  v.result("pieces_damaged", r.pieces_damaged, "Pieces of an earlier run that were damaged and made again.");
  v.result("strips_read_again", r.strips_read_again, core::if_any(),
           "Flight lines or files read again: their points were removed once written.");
  v.result("seconds", r.time.seconds, core::seconds(), "Time of the run.");
  v.result("processor_seconds", r.time.processor, core::seconds(), "Processor time of the run.");
  v.result("threads", r.threads, "Threads in use.");
}

}  // namespace swath::pipeline
