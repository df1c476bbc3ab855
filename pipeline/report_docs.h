// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of the keys of report.json from the stages' own declarations (core/config/result.h): their documentation, their JSON
// Schema, and how a text shows them.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/result_visitors.h"
#include "core/config/value.h"

namespace swath::pipeline {

/// The generated part of docs/report.md.
std::string report_page();

/// JSON Schema of report.json.
core::Value report_schema();

/// The findings that a stage declares, by path ("fit.rms_m", "pairs[].n"); empty where it declares none, or there is no such stage.
std::map<std::string, core::ResultDoc> declared_findings(std::string_view stage);

/// A finding that a key of [run.limits] judges: its path in the findings of a stage.
struct LimitedFinding {
  std::string stage, path, limit;
};
const std::vector<LimitedFinding>& limited_findings();

/// The value at a dotted path of tables, or nullptr.
const core::Value* value_at(const core::Value& tables, std::string_view path);

}  // namespace swath::pipeline
