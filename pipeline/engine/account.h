// SPDX-License-Identifier: GPL-3.0-or-later
// What a run says of one stage, and what the work folder keeps of it with every finished piece.
#pragma once

#include <cstdint>
#include <optional>

#include "core/config/result.h"
#include "core/report.h"
#include "pipeline/work/time_spent.h"
#include "stages/stage.h"

namespace swath::pipeline {

struct Account {
  std::uint64_t in = 0, out = 0;
  std::uint64_t cut = 0;  ///< tiles that were worked on in parts
  TimeSpent time{};
  core::Tally tally;
  core::Value findings = core::Value::object();

  /// Adds a piece: counts, time and tally.
  void add(const Account& o) {
    in += o.in, out += o.out, cut += o.cut, time += o.time;
    tally.add(o.tally);
  }
};

template <class V>
void describe(const Account& a, V& v) {
  v.result("in", a.in, "Points that came in.");
  v.result("out", a.out, "Points that went on.");
  v.result("cut", a.cut, "Tiles that were worked on in parts.");
  v.result("seconds", a.time.seconds, core::seconds(), "Time that the piece took.");
  v.result("processor_seconds", a.time.processor, core::seconds(), "Processor time that the piece took.");
  v.tables("records", a.tally.records(), "Records that the stage found in files.");
  v.other("tally", a.tally.value(), "Counts with first examples.");
  v.other("findings", a.findings, "What a stage found that works once on the survey.");
}

/// From what a work folder kept; nothing where a part is missing.
std::optional<Account> account_of(const core::Value& note);

/// Throws core::Error where records of a stage's files are neither handed on nor counted as left out.
void expect_balance(const core::Tally& tally, const stages::Stage& stage);

}  // namespace swath::pipeline
