// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "stages/entry.h"

namespace swath::stages {

/// Every stage there is, in the order of the chain.
const std::vector<Entry>& registry();

/// Their names, in that order.
std::vector<std::string> stage_names();

/// A new stage of that name with its defaults, or nullptr.
std::unique_ptr<Stage> make_stage(std::string_view name);

}  // namespace swath::stages
