// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/toml_text.h"

#include <array>
#include <cstdio>

#include "core/config/units.h"
#include "core/error.h"

namespace swath::io {
namespace {

using core::Value;

std::string basic_string(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (c == '\n') {
      out += "\\n";
    } else if ((c >= 0 && c < ' ') || c == 0x7f) {  // control characters; what is above 0x7f is part of UTF-8
      std::array<char, 8> code{};
      std::snprintf(code.data(), code.size(), "\\u%04x", static_cast<unsigned>(c));
      out += code.data();
    } else {
      out += c;
    }
  }
  return out + "\"";
}

void write_table(const Value& table, const std::string& path, std::string& out) {
  for (const auto& [key, v] : table.members())
    if (!v.is_null() && !v.is_object() && !is_table_list(v)) out += key + " = " + toml_scalar(v) + "\n";
  for (const auto& [key, v] : table.members()) {
    const std::string name = path.empty() ? key : path + "." + key;
    if (v.is_object()) {
      if (v.members().empty()) continue;
      out += "\n[" + name + "]\n";
      write_table(v, name, out);
    } else if (is_table_list(v)) {
      for (const Value& item : v.items()) {
        out += "\n[[" + name + "]]\n";
        write_table(item, name, out);
      }
    }
  }
}

}  // namespace

bool is_table_list(const Value& v) { return v.is_array() && !v.items().empty() && v.items().front().is_object(); }

std::string toml_scalar(const Value& v) {
  if (v.is_bool()) return v.as_bool() ? "true" : "false";
  if (v.is_int()) return std::to_string(v.as_int());
  if (v.is_number()) {
    const std::string text = core::format_number(v.as_number());
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
  }
  if (v.is_text()) return basic_string(v.as_text());
  if (v.is_array()) {
    std::string out = "[";
    for (const Value& item : v.items()) out += (out.size() > 1 ? ", " : "") + toml_scalar(item);
    return out + "]";
  }
  throw core::Error("a value of kind " + std::string(v.kind()) + " has no place in a TOML list");
}

std::string to_toml(const Value& tree) {
  std::string out;
  write_table(tree, "", out);
  return out;
}

}  // namespace swath::io
