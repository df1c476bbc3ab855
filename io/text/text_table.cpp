// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/text_table.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "io/text/data_lines.h"
#include "io/text/decimal_comma.h"
#include "io/text/line_reader.h"

namespace swath::io {

namespace {

bool is_row(const std::vector<std::string>& fields) {
  const auto is_number = [](const std::string& f) {
    double ignored = 0;
    return read_number(with_point(f), ignored);
  };
  return std::count_if(fields.begin(), fields.end(), is_number) >= 2;
}

/// Without columns where a header or a single row is all that the file holds.
DelimitedLayout layout_of(const std::filesystem::path& file, const std::string& delimiter) {
  try {
    DelimitedLayout out = inspect_delimited(file, delimiter);
    if (!is_row(out.names)) return out;  // else a row of another form than the next one
  } catch (const core::Error&) {         // what is no text is refused as it is read
  }
  return {};
}

}  // namespace

TextTable::TextTable(const std::filesystem::path& file, const std::string& delimiter, Header header) : file_(file) {
  if (header == Header::if_any) layout_ = layout_of(file, delimiter);
  const bool is_known = layout_.columns > 0;
  const std::uint64_t begin = layout_.cut_line > 0 ? layout_.cut_line : layout_.data_line;
  layout_.columns = layout_.names.size();
  const auto parted_by = [&](const std::string& line) {
    if (is_known) return layout_.delimiter;
    return layout_.delimiter = delimiter.empty() ? delimiter_in(line) : delimiter_from(delimiter, file);
  };
  for_each_data_line(file, parted_by, [&](DataLine& line) {
    if (is_known && line.line < begin) return;
    if (layout_.columns == 0) {
      layout_.columns = line.fields.size();
      if (!is_known && (header == Header::first_line || !is_row(line.fields))) {
        layout_.names = std::move(line.fields);
        return;
      }
      if (line.fields.back().empty()) --layout_.columns;  // the delimiter at the line's end
    }
    if (line.fields.size() == layout_.columns + 1 && line.fields.back().empty()) line.fields.pop_back();
    line.expect_columns(layout_.columns, !layout_.names.empty());
    lines_.push_back(line.line);
    rows_.push_back(std::move(line.fields));
  });
  layout_.decimal_comma = are_decimal_commas(rows_, layout_.delimiter);
  if (rows_.empty())
    throw core::Error("no row of data", file.string(), layout_.names.empty() ? "the file is empty" : "the file holds a header only");
}

std::string TextTable::column_name(size_t column) const {
  return column < layout_.names.size() ? "'" + layout_.names[column] + "'" : std::to_string(column + 1);
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
    throw core::Error(of + " has no name in column " + column_name(column), place(row), "name it, or take the line out");
  return text(row, column);
}

int TextTable::whole_number(size_t row, size_t column, const std::string& what) const {
  constexpr double largest = 1e9;
  const double value = number(row, column);
  if (value != std::floor(value) || std::abs(value) > largest)
    throw core::Error(what + " is not a whole number: " + text(row, column), place(row), "correct the line, or name another column");
  return static_cast<int>(value);
}

std::string TextTable::pointed(size_t row, size_t column) const {
  return layout_.decimal_comma ? with_point(text(row, column)) : text(row, column);
}

double TextTable::coordinate(size_t row, size_t column) const {
  const std::string field = pointed(row, column);
  if (field.empty()) return std::numeric_limits<double>::quiet_NaN();
  const char *begin = field.data() + (field.size() > 1 && field[0] == '+' ? 1 : 0), *stop = field.data() + field.size();
  double value = 0;
  const auto [end, bad] = std::from_chars(begin, stop, value);
  if (bad == std::errc::result_out_of_range && end == stop) return std::numeric_limits<double>::infinity();
  if (bad != std::errc{} || end != stop)
    throw core::Error("'" + text(row, column) + "' is no number in column " + column_name(column), place(row),
                      number_hint(text(row, column), "correct the line, or name another column"));
  return value;
}

double TextTable::number(size_t row, size_t column) const {
  const double value = coordinate(row, column);
  if (!std::isfinite(value))
    throw core::Error((text(row, column).empty() ? "the field is empty" : "'" + text(row, column) + "' is no finite number") +
                          std::string(" in column ") + column_name(column),
                      place(row), "correct the line, or name another column");
  return value;
}

}  // namespace swath::io
