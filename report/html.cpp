// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/html.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

namespace swath::report {
namespace {

void append_utf8(std::string& out, char32_t c) {
  const auto byte = [&](char32_t v) { out += static_cast<char>(static_cast<unsigned char>(v)); };
  if (c < 0x80) {
    byte(c);
  } else if (c < 0x800) {
    byte(0xC0 | (c >> 6));
    byte(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    byte(0xE0 | (c >> 12));
    byte(0x80 | ((c >> 6) & 0x3F));
    byte(0x80 | (c & 0x3F));
  } else {
    byte(0xF0 | (c >> 18));
    byte(0x80 | ((c >> 12) & 0x3F));
    byte(0x80 | ((c >> 6) & 0x3F));
    byte(0x80 | (c & 0x3F));
  }
}

constexpr char32_t replacement = 0xFFFD;
bool is_scalar(char32_t c) { return c < 0xD800 || (c > 0xDFFF && c <= 0x10FFFF); }

/// The code points of UTF-8 text, U+FFFD for a damaged byte; blanks for control characters.
std::vector<char32_t> code_points(std::string_view text) {
  std::vector<char32_t> out;
  for (size_t k = 0; k < text.size();) {
    const auto lead = static_cast<unsigned char>(text[k++]);
    const int more = lead < 0x80                   ? 0
                     : lead >= 0xF0 && lead < 0xF8 ? 3
                     : lead >= 0xE0 && lead < 0xF0 ? 2
                     : lead >= 0xC2 && lead < 0xE0 ? 1
                                                   : -1;
    char32_t code = more == 0 ? lead : lead & (0x3Fu >> std::max(more, 0));
    int got = 0;
    for (; got < more && k < text.size() && (static_cast<unsigned char>(text[k]) & 0xC0u) == 0x80u; ++got, ++k)
      code = (code << 6) | (static_cast<unsigned char>(text[k]) & 0x3Fu);
    const bool whole = got == more && is_scalar(code), control = (code < 0x20 && code != '\n') || code == 0x7F;
    out.push_back(!whole ? replacement : control ? U' ' : code);
  }
  return out;
}

/// Thin blanks that no line breaks at, counted from the decimal point.
std::string grouped(const std::string& digits) {
  constexpr size_t longest_plain = 4;
  if (digits.size() <= longest_plain) return digits;
  std::string out;
  for (size_t k = 0; k < digits.size(); ++k) {
    if (k > 0 && (digits.size() - k) % 3 == 0) out += "\u202F";
    out += digits[k];
  }
  return out;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  for (const char32_t c : code_points(text)) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        append_utf8(out, c);
    }
  return out;
}

std::string plain(std::string_view text) {
  std::string out;
  for (const char32_t c : code_points(text)) append_utf8(out, c == '\n' ? U' ' : c);
  return out;
}

std::string base64(std::string_view bytes) {
  constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t group = 0;
    for (size_t b = 0; b < 3; ++b) group = group << 8 | (k + b < bytes.size() ? static_cast<unsigned char>(bytes[k + b]) : 0u);
    for (size_t b = 0; b < 4; ++b) out += k + b <= bytes.size() ? letters[group >> (18 - 6 * b) & 63u] : '=';
  }
  return out;
}

std::string number_text(double v, int decimals) {
  if (!std::isfinite(v)) return "–";
  char text[400];
  const auto end = std::to_chars(text, text + sizeof text, std::abs(v), std::chars_format::fixed, decimals).ptr;
  const std::string all(text, end);
  const size_t point = std::min(all.find('.'), all.size());
  const bool zero = all.find_first_not_of("0.") == std::string::npos;
  return (v < 0 && !zero ? "−" : "") + grouped(all.substr(0, point)) + all.substr(point);
}

std::string count_text(std::uint64_t n) { return grouped(std::to_string(n)); }

}  // namespace swath::report
