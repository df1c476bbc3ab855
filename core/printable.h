// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of other people's files, made fit for a terminal, for JSON and for CSV.
#pragma once

#include <string>
#include <string_view>

namespace swath::core {

/// `text` with control characters (but for tab and line feed) and bytes that are not UTF-8 written as \xNN: a file's header cannot move the
/// cursor, change colours or break the encoding of what is printed.
std::string printable(std::string_view text);

/// `text` with bytes that are not UTF-8 written as \xNN, control characters as they are.
std::string utf8(std::string_view text);

/// `text` with what is longer than a person reads cut out of its middle: of a word its first and last characters stay, of lines beyond some
/// dozens their number. For error messages that quote what they were given.
std::string shortened(std::string_view text);

/// `text` as one field of a CSV file (RFC 4180), quoted where it has to be. A text that a spreadsheet would take for a formula (it begins
/// with = + - @ or a tab, and is no number) gets an apostrophe in front.
std::string csv_field(std::string_view text);

/// Of the letters A to Z.
std::string lower_case(std::string text);

}  // namespace swath::core
