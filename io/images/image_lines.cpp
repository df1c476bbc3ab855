// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/images/image_lines.h"

#include <charconv>
#include <cmath>

#include "core/error.h"
#include "io/text/data_lines.h"
#include "io/text/line_reader.h"

namespace swath::io {

ImageLines::ImageLines(const std::filesystem::path& file) : file_(file), text_(read_lines(file)) {}

bool ImageLines::next(std::string_view& line) {
  if (at_ >= text_.size()) return false;
  const size_t end = std::min(text_.find('\n', at_), text_.size());
  line = std::string_view(text_).substr(at_, end - at_);
  if (line.ends_with('\r')) line.remove_suffix(1);
  at_ = end + 1;
  ++line_;
  return true;
}

bool ImageLines::next_data(std::string_view& line) {
  while (next(line)) {
    const size_t first = line.find_first_not_of(" \t");
    if (first != std::string_view::npos && line[first] != '#') return true;
  }
  return false;
}

std::string ImageLines::place() const { return file_.string() + ":" + std::to_string(line_); }

void ImageLines::fail(const std::string& what, const std::string& hint) const { throw core::Error(what, place(), hint); }

double ImageLines::number_in(std::string_view word, std::string_view name) const {
  double value = 0.0;
  if (!read_number(word, value) || !std::isfinite(value)) fail(std::string(name) + " is not a number: \"" + std::string(word) + "\"");
  return value;
}

std::uint64_t ImageLines::count_in(std::string_view word, std::string_view name) const {
  std::uint64_t value = 0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || end != word.data() + word.size())
    fail(std::string(name) + " is not a whole number: \"" + std::string(word) + "\"");
  return value;
}

std::optional<int> pixel_count(double value) {
  constexpr double max_pixels = 1e6;
  if (!(value >= 1.0 && value <= max_pixels && value == std::floor(value))) return std::nullopt;
  return static_cast<int>(value);
}

std::vector<std::string_view> blank_words(std::string_view line) {
  std::vector<std::string_view> out;
  constexpr std::string_view blanks = " \t";
  for (size_t at = line.find_first_not_of(blanks); at != std::string_view::npos;) {
    const size_t end = std::min(line.find_first_of(blanks, at), line.size());
    out.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(blanks, end);
  }
  return out;
}

}  // namespace swath::io
