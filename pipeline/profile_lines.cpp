// SPDX-License-Identifier: GPL-3.0-or-later
// The lines that a request for profiles names.
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>

#include "core/config/units.h"
#include "core/error.h"
#include "io/text/delimited.h"
#include "pipeline/line_file.h"
#include "pipeline/profile.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using Point = Eigen::Vector2d;

double number(const std::string& text, const std::string& where) {
  double v = 0.0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), v);
  if (fault != std::errc{} || end != text.data() + text.size() || !std::isfinite(v))
    throw core::usage_error("'" + text + "' is no coordinate", where, "write x,y in the units of the data");
  return v;
}

Point place(const std::string& text, const std::string& where) {
  const auto parts = io::split_delimited(text, ',');
  if (parts.size() != 2) throw core::usage_error("'" + text + "' is no place", where, "write x,y in the units of the data");
  return {number(parts[0], where), number(parts[1], where)};
}

/// Text with a header that names x and y, and a column `profile` (or `name`) where it holds several lines.
std::vector<ProfileLine> lines_of_text(const fs::path& file) {
  std::ifstream in(file);
  if (!in) throw core::Error("cannot read the profiles' lines", file.string(), "check the name");
  std::string row;
  std::getline(in, row);
  const char delimiter = io::delimiter_in(row);
  const auto names = io::split_delimited(row, delimiter);
  const auto column = [&](std::initializer_list<const char*> wanted) {
    for (size_t k = 0; k < names.size(); ++k)
      for (const char* w : wanted)
        if (names[k] == w) return static_cast<int>(k);
    return -1;
  };
  const int x = column({"x", "easting", "E"}), y = column({"y", "northing", "N"}), name = column({"profile", "name"});
  if (x < 0 || y < 0) throw core::Error("the header names no columns x and y", file.string(), "the first line is: profile,x,y");
  std::vector<ProfileLine> out;
  for (int n = 2; std::getline(in, row); ++n) {
    if (row.find_first_not_of(" \t\r") == std::string::npos) continue;
    const auto fields = io::split_delimited(row, delimiter);
    const std::string where = file.string() + ":" + std::to_string(n);
    if (fields.size() != names.size())
      throw core::Error("the line has " + core::counted(fields.size(), "field") + ", the header " + std::to_string(names.size()), where);
    const std::string mine = name < 0 ? "profile" : fields[static_cast<size_t>(name)];
    if (out.empty() || out.back().name != mine) out.push_back({mine, {}});
    out.back().vertices.emplace_back(number(fields[static_cast<size_t>(x)], where), number(fields[static_cast<size_t>(y)], where));
  }
  return out;
}

}  // namespace

std::vector<ProfileLine> profile_lines(const ProfileRequest& request, const core::Crs& crs) {
  std::vector<ProfileLine> out;
  if (!request.lines.empty()) {
    const std::string ending = request.lines.extension().string();
    if (ending == ".csv" || ending == ".txt") {
      out = lines_of_text(request.lines);
    } else {
      for (const io::VectorLine& line : read_lines_in(request.lines, crs)) {
        out.push_back({"profile_" + std::to_string(out.size() + 1), {}});
        for (size_t k = 0; k < line.x.size(); ++k) out.back().vertices.emplace_back(line.x[k], line.y[k]);
      }
    }
  } else if (!request.from.empty() && !request.to.empty()) {
    out.push_back({"profile", {place(request.from, "--from"), place(request.to, "--to")}});
  } else {
    throw core::usage_error("no line to cut along is named", "swath profile", "give --line FILE, or --from x,y and --to x,y");
  }
  if (out.empty()) throw core::Error("the file holds no line", request.lines.string());
  for (ProfileLine& line : out) line.left_out = std::erase_if(line.vertices, [](const Point& p) { return !is_on_a_map(p.x(), p.y()); });
  std::map<std::string, int> seen;
  for (ProfileLine& line : out) {
    for (char& c : line.name)
      if (c == '/' || static_cast<unsigned char>(c) < 0x20) c = '_';
    if (seen[line.name]++ > 0) line.name += "_" + std::to_string(seen[line.name]);
    double length = 0.0;
    for (size_t k = 1; k < line.vertices.size(); ++k) length += (line.vertices[k] - line.vertices[k - 1]).norm();
    if (!(length > 0.0))
      throw core::Error("the line has no length", request.lines.empty() ? "swath profile" : request.lines.string() + ": " + line.name);
  }
  return out;
}

}  // namespace swath::pipeline
