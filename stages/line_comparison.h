// SPDX-License-Identifier: GPL-3.0-or-later
// What quality.lines hands to the stages behind it: lines.json.
#pragma once

#include <optional>

#include "quality/known_lines.h"
#include "quality/line_offsets.h"
#include "stages/stage.h"

namespace swath::stages {

/// One tile's cells as an intermediate file, in the machine's byte order.
void write_line_cells(const std::filesystem::path& file, const quality::LineCells& cells);
/// Appends them to `cells`; throws core::Error where the file is damaged.
void read_line_cells(const std::filesystem::path& file, quality::LineCells& cells);

/// Nothing where no stage before this one has compared the lines.
std::optional<quality::KnownLines> known_lines(const Context& context);

}  // namespace swath::stages
