// SPDX-License-Identifier: GPL-3.0-or-later
// What --set changes in a config: a value is true or false, a number, a list [a, b, c], or text.
#pragma once

#include <string>

#include "core/config/value.h"

namespace swath::pipeline {

/// Does the name fit the stage's type? Its last word is its short name: "smrf" of "filters.smrf".
bool is_named(const std::string& type, const std::string& name);

/// Sets one option of a table of options from "key=value" or "table.key=value". Throws core::Error (usage).
void set_option(core::Value& table, const std::string& set);

/// Sets "run.key=value", or "stage.key=value" of every stage of a pipeline that the name fits, by its type or the type's last word; the
/// longest name that fits is meant. Throws core::Error (usage), naming the stages.
void set_stage_option(core::Value& pipeline, const std::string& set);

}  // namespace swath::pipeline
