// SPDX-License-Identifier: GPL-3.0-or-later
// Texts made from the stages' own declarations: terminal help and the generated parts of the documentation.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/config/value.h"

namespace swath::pipeline {

/// One line per stage, in the order of the chain.
std::string stage_list();
/// Everything a stage says of itself. Throws core::Error (usage) for an unknown name, naming the nearest.
std::string stage_help(const std::string& name);

/// Names of the stages, in the order of the chain.
std::vector<std::string> stage_names();
/// What --set takes, as it takes it: "dtm.cell", "run.tile"; options within lists of tables are left out.
std::vector<std::string> settable_options();

/// JSON Schema of pipelines and, under "$defs", of surveys and of report.json.
core::Value schema();

/// Writes the generated part of every page in `docs` (between "<!-- generated -->" and "<!-- end -->"): stages/NAME.md,
/// survey.md, lever-arm.md, report.md, run.md. With `only_check` nothing is written. Returns the pages that differ (or differed).
std::vector<std::filesystem::path> write_docs(const std::filesystem::path& docs, bool only_check);

}  // namespace swath::pipeline
