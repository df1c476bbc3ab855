// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers of image files share: lines of any length, words, numbers with their place, names numbered in their order.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace swath::io {

/// The lines of a whole file in memory, of any length (a line of COLMAP holds all points of an image).
class ImageLines {
 public:
  explicit ImageLines(const std::filesystem::path& file);
  /// The next line without its end; false at the end of the file.
  bool next(std::string_view& line);
  /// The next line that is not empty and no comment (#).
  bool next_data(std::string_view& line);
  std::uint64_t number() const { return line_; }
  std::string place() const;
  /// Throws core::Error "file:line: what".
  [[noreturn]] void fail(const std::string& what, const std::string& hint = {}) const;
  /// A finite number; fail() otherwise.
  double number_in(std::string_view word, std::string_view name) const;
  /// A whole number, not below 0.
  std::uint64_t count_in(std::string_view word, std::string_view name) const;

 private:
  std::filesystem::path file_;
  std::string text_;
  size_t at_ = 0;
  std::uint64_t line_ = 0;
};

/// The words of a line between blanks and tabs.
std::vector<std::string_view> blank_words(std::string_view line);

/// Columns or rows of an image: whole, from 1 to a million; nothing otherwise.
std::optional<int> pixel_count(double value);

/// Names numbered from 0 in the order they come.
class NumberedNames {
 public:
  explicit NumberedNames(std::vector<std::string>& names) : names_(&names) {}
  std::uint32_t operator()(std::string_view name) {
    const auto [it, is_new] = number_.try_emplace(std::string(name), static_cast<std::uint32_t>(names_->size()));
    if (is_new) names_->emplace_back(name);
    return it->second;
  }

 private:
  std::vector<std::string>* names_;
  std::unordered_map<std::string, std::uint32_t> number_;
};

}  // namespace swath::io
