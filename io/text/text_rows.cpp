// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/text_rows.h"

#include <array>
#include <charconv>
#include <cmath>

namespace swath::io {
namespace {

constexpr size_t flush_at = 1u << 20;  // bytes

template <class... Style>
void put(std::string& to, double v, Style... style) {
  std::array<char, 400> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), v, style...);
  to.append(text.data(), end.ptr);
}

}  // namespace

int decimals_of(double first, double step, int least) {
  const double scale = std::pow(10.0, least);
  constexpr double rounding = 1e-4;  // of the last decimal: seconds of a week resolve 1e-10 s
  for (const double v : {first * scale, step * scale})
    if (std::abs(v - std::round(v)) > rounding) return 9;
  return least;
}

TextRows::TextRows(const std::filesystem::path& file, const std::string& header)
    : output_(file), out_(output_.temporary(), file), buffer_(header) {}

void TextRows::separate() {
  if (!first_) buffer_ += ',';
  first_ = false;
}

void TextRows::number(double v, int decimals) {
  separate();
  put(buffer_, v, std::chars_format::fixed, decimals);
}

void TextRows::scientific(double v, int decimals) {
  separate();
  put(buffer_, v, std::chars_format::scientific, decimals);
}

void TextRows::shortest(double v) {
  separate();
  put(buffer_, v);
}

void TextRows::end() {
  buffer_ += '\n';
  first_ = true;
  if (buffer_.size() < flush_at) return;
  out_.append(buffer_.data(), buffer_.size());
  buffer_.clear();
}

void TextRows::commit() {
  out_.append(buffer_.data(), buffer_.size());
  out_.close();
  output_.commit();
}

}  // namespace swath::io
