// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/fields.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "core/error.h"

namespace swath::io {
namespace fields {

void trim(const char*& begin, const char*& end) {
  while (begin < end && (is_blank(*begin) || *begin == '\r')) ++begin;
  while (begin < end && (is_blank(end[-1]) || end[-1] == '\r')) --end;
}

void trim_line(const char*& begin, const char*& end, char delimiter) {
  if (delimiter != '\t') return trim(begin, end);
  const auto is_outer = [](char c) { return c == ' ' || c == '\r'; };
  while (begin < end && is_outer(*begin)) ++begin;
  while (begin < end && is_outer(end[-1])) --end;
}

bool parse_number(const char* begin, const char* end, double& value) {
  trim(begin, end);
  if (end - begin >= 2 && *begin == '"' && end[-1] == '"') {
    ++begin;
    --end;
    trim(begin, end);
  }
  if (begin == end) {
    value = std::nan("");
    return true;
  }
  if (*begin == '+' && end - begin > 1 && begin[1] != '-') ++begin;
  const auto [at, ec] = std::from_chars(begin, end, value);
  if (ec == std::errc::result_out_of_range && at == end) {
    // Too small counts as zero, too large as infinity, as strtod has it.
    value = std::strtod(std::string(begin, end).c_str(), nullptr);
    return true;
  }
  return ec == std::errc() && at == end;
}

const char* field_end(const char* at, const char* end, char delimiter) {
  if (delimiter == ' ') {
    while (at < end && !is_blank(*at)) ++at;
    return at;
  }
  bool quoted = false;
  for (; at < end; ++at) {
    if (*at == '"') quoted = !quoted;
    if (*at == delimiter && !quoted) return at;
  }
  return end;
}

}  // namespace fields

using namespace fields;

std::vector<std::string> split_delimited(const std::string& line, char delimiter) {
  std::vector<std::string> out;
  const char* at = line.data();
  const char* end = at + line.size();
  trim_line(at, end, delimiter);
  for (;;) {
    if (delimiter == ' ')
      while (at < end && is_blank(*at)) ++at;
    const char* stop = field_end(at, end, delimiter);
    const char *b = at, *e = stop;
    trim(b, e);
    if (e - b >= 2 && *b == '"' && e[-1] == '"') {
      ++b;
      --e;
    }
    out.emplace_back(b, e);
    if (stop >= end) return out;
    at = stop + 1;
  }
}

char delimiter_in(const std::string& line) {
  const char *b = line.data(), *e = b + line.size();
  trim(b, e);
  for (const char c : {'\t', ';', ','})
    if (std::find(b, e, c) != e) return c;
  return ' ';
}

char delimiter_from(const std::string& stated, const std::filesystem::path& file) {
  if (stated == "tab" || stated == "\\t") return '\t';
  if (stated == "blank" || stated == "space") return ' ';
  if (stated.size() == 1 && std::strchr(",;\t |:", stated[0])) return stated[0];
  throw core::usage_error("delimiter '" + stated + "' is not one of , ; tab blank | :", file.string());
}

}  // namespace swath::io
