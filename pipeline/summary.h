// SPDX-License-Identifier: GPL-3.0-or-later
// Reports and explanations as text for a terminal.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/config/value.h"
#include "core/error.h"
#include "pipeline/plan.h"

namespace swath::pipeline {

/// The end of a run on one screen: products, counts, errors against truth where it is present.
std::string summary(const core::Value& report, const std::filesystem::path& output);

/// An error that ended a run after its geometry was judged: what was named is added to the hint, for it is likely to be the cause. Faults
/// of the config and those within a file of `inputs` have others. `geometry`: the findings of quality.geometry; null where there are none.
core::Error with_geometry(const core::Error& error, const core::Value* geometry, const std::vector<std::filesystem::path>& inputs);

/// `explain` as text: one line per option, value and origin.
std::string explanation_text(const Explanation& explanation);

}  // namespace swath::pipeline
