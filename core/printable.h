// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of other people's files, made fit for a terminal and for JSON.
#pragma once

#include <string>
#include <string_view>

namespace swath::core {

/// `text` with control characters (but for tab and line feed) and bytes that are not UTF-8 written as \xNN: a file's header cannot move the
/// cursor, change colours or break the encoding of what is printed.
std::string printable(std::string_view text);

/// `text` with bytes that are not UTF-8 written as \xNN, control characters as they are.
std::string utf8(std::string_view text);

}  // namespace swath::core
