// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/other_cloud.h"

#include <algorithm>

namespace swath::io {
namespace {

/// Numbers in lines, perhaps behind a header.
bool is_text_of_numbers(std::string_view start) {
  const auto is_plain = [](char c) { return c == '\t' || c == '\n' || c == '\r' || static_cast<unsigned char>(c) >= ' '; };
  return std::all_of(start.begin(), start.end(), is_plain) && start.find_first_of("0123456789") != std::string_view::npos &&
         start.find_first_of("\r\n") != std::string_view::npos;
}

}  // namespace

OtherCloud other_cloud(std::string_view start) {
  if (start.starts_with("ply\n") || start.starts_with("ply\r")) return OtherCloud::ply;
  if (start.starts_with("ASTM-E57")) return OtherCloud::e57;
  if (start.starts_with("# .PCD")) return OtherCloud::pcd;
  return is_text_of_numbers(start) ? OtherCloud::text : OtherCloud::none;
}

std::string name_of(OtherCloud kind) {
  switch (kind) {
    case OtherCloud::ply:
      return "a PLY file";
    case OtherCloud::e57:
      return "an E57 file";
    case OtherCloud::pcd:
      return "a PCD file";
    case OtherCloud::text:
      return "text";
    case OtherCloud::none:
      break;
  }
  return "of no kind that is known here";
}

std::string conversion_of(OtherCloud kind, const std::filesystem::path& file) {
  std::filesystem::path made = file.filename();
  made.replace_extension(".laz");
  const std::string translate = "`pdal translate " + file.filename().string() + " " + made.string();
  if (kind == OtherCloud::text)
    return "convert it with CloudCompare or PDAL, which needs the names of the columns: " + translate +
           " -r readers.text --readers.text.header=\"X Y Z\"`";
  return "convert it with CloudCompare or PDAL" + std::string(kind == OtherCloud::e57 ? " with its plugin for E57: " : ": ") + translate +
         "`";
}

}  // namespace swath::io
