// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "core/config/value.h"
#include "pipeline/plan.h"

namespace swath::pipeline {

/// A plan as a config: [run] and the stages with every option that was given, wherever it was given.
core::Value config_of(const Plan& plan);

/// Writes what `swath run FILE` needs to do the same again: the plan as a config, and beside it NAME.survey.toml with a survey that no file
/// holds (Plan::survey_tree). `typed`: the command line. Throws core::Error (usage) where one of them is there with another content.
void save_config(const Plan& plan, const std::filesystem::path& file, const std::string& typed);

}  // namespace swath::pipeline
