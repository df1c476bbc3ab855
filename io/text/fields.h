// SPDX-License-Identifier: GPL-3.0-or-later
// A line of delimited text as fields.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace swath::io {

/// The fields of one line, without blanks and quotes around them.
std::vector<std::string> split_delimited(const std::string& line, char delimiter);
/// The delimiter of a line of data: tab, semicolon or comma where it has one, else ' ' for blanks.
char delimiter_in(const std::string& line);
/// The delimiter that a survey states as "," ";" "tab" "blank" ...; ' ' stands for blanks. Throws Error where it is none.
char delimiter_from(const std::string& stated, const std::filesystem::path& file);

/// Of lines in a buffer: [begin, end).
namespace fields {

inline bool is_blank(char c) { return c == ' ' || c == '\t'; }
void trim(const char*& begin, const char*& end);
/// The blanks around a line: a tab that parts fields is none, for the field at its side may be empty.
void trim_line(const char*& begin, const char*& end, char delimiter);
/// Parses a trimmed field; quotes around it and a leading plus are allowed, an empty field is NaN.
bool parse_number(const char* begin, const char* end, double& value);
/// The end of the field that starts at `at`; quotes protect delimiters.
const char* field_end(const char* at, const char* end, char delimiter);

}  // namespace fields

}  // namespace swath::io
