// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/decimal_comma.h"

#include <algorithm>
#include <utility>

#include "io/text/line_reader.h"

namespace swath::io {
namespace {

size_t digits_from(std::string_view text, size_t at) {
  const size_t end = text.find_first_not_of("0123456789", at);
  return (end == text.npos ? text.size() : end) - at;
}

/// May the comma part thousands? "1,234", but neither "1,5" nor "0,123" nor "1234,567".
bool may_be_thousands(std::string_view field) {
  const size_t begin = field.find_first_of("0123456789"), comma = field.find(',');
  return comma - begin <= 3 && field[begin] != '0' && digits_from(field, comma + 1) == 3 && comma + 4 == field.size();
}

}  // namespace

bool has_decimal_comma(std::string_view field) {
  const size_t comma = field.find(',');
  if (comma == field.npos || comma == 0 || field.find_first_of(".,", comma + 1) != field.npos) return false;
  const size_t begin = field[0] == '-' || field[0] == '+' ? 1 : 0;
  if (digits_from(field, begin) == 0 || begin + digits_from(field, begin) != comma || digits_from(field, comma + 1) == 0) return false;
  std::string pointed(field);
  pointed[comma] = '.';
  double ignored = 0;
  return read_number(pointed, ignored);
}

std::string with_point(std::string field) {
  if (has_decimal_comma(field)) field[field.find(',')] = '.';
  return field;
}

std::vector<std::string> with_points(std::vector<std::string> fields) {
  for (std::string& f : fields) f = with_point(std::move(f));
  return fields;
}

bool are_decimal_commas(const std::vector<std::vector<std::string>>& records, char delimiter) {
  if (delimiter != ';' && delimiter != '\t') return false;
  bool sure = false;
  double ignored = 0;
  for (const std::vector<std::string>& fields : records)
    for (const std::string& f : fields) {
      if (f.find('.') != f.npos && read_number(f, ignored)) return false;
      sure = sure || (has_decimal_comma(f) && !may_be_thousands(f));
    }
  return sure;
}

}  // namespace swath::io
