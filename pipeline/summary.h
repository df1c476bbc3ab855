// SPDX-License-Identifier: GPL-3.0-or-later
// Reports and explanations as text for a terminal.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/value.h"

namespace swath::pipeline {

/// The end of a run on one screen: products, counts, errors against truth where it is present.
std::string summary(const core::Value& report, const std::filesystem::path& output);

/// `explain` as text: one line per option, value and origin.
std::string explanation_text(const core::Value& explanation);

}  // namespace swath::pipeline
