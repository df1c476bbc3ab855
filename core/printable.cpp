// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/printable.h"

#include <algorithm>
#include <charconv>
#include <cstddef>

namespace swath::core {
namespace {

unsigned byte_at(std::string_view text, std::size_t i) { return static_cast<unsigned char>(text[i]); }

/// Bytes of the UTF-8 character (RFC 3629) that begins at `i`; 0 where none does.
std::size_t length_of(std::string_view text, std::size_t i) {
  const unsigned first = byte_at(text, i);
  if (first < 0x80) return 1;
  const std::size_t n = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || i + n > text.size()) return 0;
  for (std::size_t k = 1; k < n; ++k)
    if ((byte_at(text, i + k) & 0xc0U) != 0x80U) return 0;
  const unsigned second = byte_at(text, i + 1);
  // Longer than need be, halves of pairs, and beyond the last code point.
  const bool refused = (first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) || (first == 0xf0 && second < 0x90) ||
                       (first == 0xf4 && second > 0x8f);
  return refused ? 0 : n;
}

/// A character that moves the cursor or begins a control sequence: C0 but for tab and line feed, delete, and C1.
bool is_control(std::string_view text, std::size_t i) {
  const unsigned c = byte_at(text, i);
  return (c < 0x20 && c != '\n' && c != '\t') || c == 0x7f || (c == 0xc2 && i + 1 < text.size() && byte_at(text, i + 1) < 0xa0);
}

std::string written_out(std::string_view text, bool controls) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    if (const std::size_t n = controls && is_control(text, i) ? 0 : length_of(text, i)) {
      out += text.substr(i, n);
      i += n;
    } else {
      out += "\\x";
      out += digits[byte_at(text, i) >> 4U];
      out += digits[byte_at(text, i) & 15U];
      ++i;
    }
  }
  return out;
}

bool is_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  return fault == std::errc() && end == text.data() + text.size();
}

}  // namespace

std::string printable(std::string_view text) { return written_out(text, true); }

std::string shortened(std::string_view text) {
  constexpr std::size_t longest_word = 400, kept_before = 150, kept_after = 50, most_lines = 60;
  std::string out;
  std::size_t lines = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = std::min(text.find_first_of(" \t\n", i), text.size());
    const std::string_view word = text.substr(i, end - i);
    if (word.size() <= longest_word)
      out += word;
    else
      out.append(word.substr(0, kept_before))
          .append("...(" + std::to_string(word.size() - kept_before - kept_after) + " characters)...")
          .append(word.substr(word.size() - kept_after));
    if (end < text.size()) out += text[end];
    i = end + 1;
    if (end < text.size() && text[end] == '\n' && ++lines == most_lines && i < text.size()) {
      const auto left = std::count(text.begin() + static_cast<std::ptrdiff_t>(i), text.end(), '\n') + (text.back() != '\n');
      return out + "... and " + std::to_string(left) + " more lines";
    }
  }
  return out;
}

std::string csv_field(std::string_view text) {
  const bool signed_text = !text.empty() && std::string_view("=+-@\t").find(text.front()) != std::string_view::npos;
  std::string field(signed_text && !is_number(text) ? "'" : "");
  field += text;
  if (field.find_first_of(",\"\n\r") == std::string::npos) return field;
  std::string quoted = "\"";
  for (const char c : field) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string utf8(std::string_view text) { return written_out(text, false); }

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

}  // namespace swath::core
