// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong with lines of delimited text, in words, and what to do about it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace swath::io {

/// What to do about a line within which the file ends.
inline constexpr const char* cut_hint = "the file was cut off as it was written or copied: copy it again, or take the line out";
/// Are these the first bytes of a file that gzip or zip has packed?
bool is_packed(std::string_view begin);
/// Does the name end as those of packed files do: .gz, .zip, .7z and others?
bool has_packed_ending(const std::filesystem::path& file);
/// What is wrong with a line whose fields are not the table's columns.
std::string fields_and_columns(size_t fields, size_t columns, bool has_header);
/// What may be the cause of a line with more fields than the table has columns.
inline constexpr const char* more_fields_hint = "a number with a decimal comma, or a text that holds the delimiter and needs quotes?";
/// What to do about a field that is not a number: a decimal comma is named.
const char* number_hint(std::string_view field, const char* otherwise);
/// Throws Error where the text's first bytes are those of UTF-16 or it holds bytes of 0: `begin` of a file, of any length.
void require_text(std::string_view begin, const std::filesystem::path& file);

}  // namespace swath::io
