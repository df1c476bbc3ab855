// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/text_table.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "io/text/data_lines.h"

namespace swath::io {

TextTable::TextTable(const std::filesystem::path& file, const std::string& delimiter) : file_(file) {
  const auto parted_by = [&](const std::string& line) {
    return layout_.delimiter = delimiter.empty() ? delimiter_in(line) : delimiter_from(delimiter, file);
  };
  for_each_data_line(file, parted_by, [&](DataLine& line) {
    if (layout_.names.empty()) {
      layout_.names = std::move(line.fields);
      layout_.columns = layout_.names.size();
      return;
    }
    if (line.fields.size() == layout_.columns + 1 && line.fields.back().empty()) line.fields.pop_back();  // the delimiter at the line's end
    line.expect_columns(layout_.columns);
    lines_.push_back(line.line);
    rows_.push_back(std::move(line.fields));
  });
  if (rows_.empty())
    throw core::Error("no row of data", file.string(), layout_.names.empty() ? "the file is empty" : "the file holds a header only");
}

std::optional<size_t> TextTable::column_if_there(const std::string& name, const std::string& usual) const {
  if (name.empty()) return std::nullopt;
  const auto folded = [](const std::string& a, const std::string& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
  };
  const bool there = std::any_of(layout_.names.begin(), layout_.names.end(), [&](const std::string& n) { return folded(n, name); });
  if (!there && name == usual) return std::nullopt;
  return column(name);
}

const std::string& TextTable::name(size_t row, size_t column, const std::string& of) const {
  if (text(row, column).empty())
    throw core::Error(of + " has no name in column '" + layout_.names[column] + "'", place(row), "name it, or take the line out");
  return text(row, column);
}

int TextTable::whole_number(size_t row, size_t column, const std::string& what) const {
  constexpr double largest = 1e9;
  const double value = number(row, column);
  if (value != std::floor(value) || std::abs(value) > largest)
    throw core::Error(what + " is not a whole number: " + text(row, column), place(row), "correct the line, or name another column");
  return static_cast<int>(value);
}

double TextTable::coordinate(size_t row, size_t column) const {
  const std::string& field = text(row, column);
  const char *begin = field.data() + (field.size() > 1 && field[0] == '+' ? 1 : 0), *stop = field.data() + field.size();
  double value = 0;
  const auto [end, bad] = std::from_chars(begin, stop, value);
  if (bad == std::errc::result_out_of_range && end == stop) return std::numeric_limits<double>::infinity();
  if (bad != std::errc{} || end != stop)
    throw core::Error(
        (field.empty() ? "the field is empty" : "'" + field + "' is no number") + std::string(" in column '") + layout_.names[column] + "'",
        place(row), number_hint(field, "correct the line, or name another column"));
  return value;
}

double TextTable::number(size_t row, size_t column) const {
  const double value = coordinate(row, column);
  if (!std::isfinite(value))
    throw core::Error("'" + text(row, column) + "' is no finite number in column '" + layout_.names[column] + "'", place(row),
                      "correct the line, or name another column");
  return value;
}

}  // namespace swath::io
