// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers with a decimal comma, as spreadsheets of half of the world write them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace swath::io {

/// "12,345", "-0,5", "1,2e-3": digits on both sides of one comma, and no point.
bool has_decimal_comma(std::string_view field);
/// The field with its comma as a point, where it has a decimal comma; others as they are.
std::string with_point(std::string field);
/// The same of all fields of a line.
std::vector<std::string> with_points(std::vector<std::string> fields);

/// Are commas the decimal signs of these records, without doubt? The delimiter is a semicolon or a tab; no field has a decimal point; and
/// one field at least has a comma that cannot part thousands: other than three digits follow it, or more than three, or a zero, precede.
bool are_decimal_commas(const std::vector<std::vector<std::string>>& records, char delimiter);

}  // namespace swath::io
