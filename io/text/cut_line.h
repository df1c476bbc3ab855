// SPDX-License-Identifier: GPL-3.0-or-later
// A logger that is read from the middle begins its file with what is left of a record; one that is copied in part ends it so.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/report.h"
#include "io/text/binary_file.h"

namespace swath::io {

/// Lines after the first that show how records are written.
constexpr size_t cut_line_context = 30;

/// Is the first line of data only the end of a record? `lines`: the fields of the first lines of data, up to cut_line_context + 1. It has
/// fewer fields than all that follow; or, where nothing stands before it in the file (`opens_file`) and all that follow are written alike,
/// its first field is not: the rest of a number, digits after the point that are fewer, no digit before the point, or, where the
/// field rises evenly, a number that lacks its leading digits. A cut that leaves a number of the usual form in another column than
/// the first is not found.
bool first_line_is_cut(const std::vector<std::vector<std::string>>& lines, bool opens_file);

/// Does the file end within its last line, which begins at byte `begin`? Asked where no line end follows it. Of up to cut_line_context
/// lines before it, ten at least, all have more fields; or all write their last field with more decimals. A cut between two numbers
/// without decimals is not found.
bool last_line_is_cut(const BinaryFile& file, std::uint64_t begin, char delimiter);

/// Counts the line (from 1; 0: none is cut) as one of the records of `kind`, left out.
void count_cut_line(std::uint64_t line, const std::filesystem::path& file, const std::string& kind, core::Tally& tally);

}  // namespace swath::io
