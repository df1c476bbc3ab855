// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces of HTML: texts and numbers as a page shows them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace swath::report {

/// Text for element content and for attributes in double quotes: & < > " ' as entities; control characters other than line feeds become
/// blanks, damaged UTF-8 U+FFFD.
std::string escaped(std::string_view text);

/// Text for one line of a drawing: control characters become blanks, damaged UTF-8 U+FFFD.
std::string plain(std::string_view text);

/// Base64 (RFC 4648, with padding).
std::string base64(std::string_view bytes);

/// A number with that many decimals, a true minus sign, and thin blanks between groups of three digits from 10 000 on; an en dash for NaN
/// and infinities. What rounds to zero has no sign.
std::string number_text(double v, int decimals);

/// The same for counts.
std::string count_text(std::uint64_t n);

}  // namespace swath::report
