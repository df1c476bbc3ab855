// SPDX-License-Identifier: GPL-3.0-or-later
// What quality.lines hands to the stages behind it: lines.json.
#pragma once

#include <optional>

#include "quality/known_lines.h"
#include "stages/stage.h"

namespace swath::stages {

/// Nothing where no stage before this one has compared the lines.
std::optional<quality::KnownLines> known_lines(const Context& context);

}  // namespace swath::stages
