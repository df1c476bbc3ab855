// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/text_faults.h"

#include <algorithm>
#include <array>

#include "core/config/units.h"
#include "core/error.h"
#include "core/printable.h"
#include "io/text/decimal_comma.h"

namespace swath::io {
namespace {

/// The program that packed a file with these first bytes; empty: none.
std::string packing_of(std::string_view begin) {
  if (begin.starts_with("\x1F\x8B")) return "gzip";
  return begin.starts_with("PK\x03\x04") ? "zip" : "";
}

}  // namespace

bool is_packed(std::string_view begin) { return !packing_of(begin).empty(); }

bool has_packed_ending(const std::filesystem::path& file) {
  constexpr std::array<std::string_view, 6> endings{".gz", ".zip", ".bz2", ".xz", ".7z", ".rar"};
  return std::find(endings.begin(), endings.end(), core::lower_case(file.extension().string())) != endings.end();
}

void require_text(std::string_view begin, const std::filesystem::path& file) {
  if (const std::string by = packing_of(begin); !by.empty())
    throw core::Error("is compressed by " + by, file.string(), "unpack it first: " + std::string(by == "gzip" ? "gunzip" : "unzip"));
  const bool marked = begin.starts_with("\xFF\xFE") || begin.starts_with("\xFE\xFF");
  const bool bare = begin.size() >= 4 && (begin[0] == '\0') != (begin[1] == '\0') && (begin[2] == '\0') != (begin[3] == '\0');
  if (marked || bare)
    throw core::Error("is text in UTF-16, which is not read", file.string(),
                      "save it as UTF-8: \"CSV UTF-8\" in a spreadsheet's list of formats");
  if (begin.find('\0') != std::string_view::npos) throw core::Error("is not delimited text", file.string(), "check the name of the file");
}

std::string fields_and_columns(size_t fields, size_t columns, bool has_header) {
  return "the line has " + core::counted(fields, "field") + (has_header ? ", the header " : ", the first line ") +
         core::counted(columns, "column");
}

const char* number_hint(std::string_view field, const char* otherwise) {
  if (has_decimal_comma(field)) return "does the comma part decimals or thousands? Write decimal points, and nothing between thousands";
  if (field.find(',') != field.npos) return "write decimal points, and nothing between thousands";
  const bool digits = field.find_first_of("0123456789") != field.npos;
  if (digits && field.find(':') != field.npos) return "times of day are not read here: export seconds, of the GPS week or of Unix";
  if (digits && (field.find_first_of(" '") != field.npos || field.find("\xC2\xB0") != field.npos))
    return "degrees, minutes and seconds are not read: export decimal degrees";
  return otherwise;
}

}  // namespace swath::io
