// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/line_comparison.h"

#include <cmath>
#include <cstring>

#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "stages/grid_tile.h"

namespace swath::stages {
namespace {

constexpr const char* file_name = "lines.json";

template <class T>
void append(std::string& bytes, const std::vector<T>& records) {
  const std::uint64_t n = records.size();
  bytes.append(reinterpret_cast<const char*>(&n), sizeof n);
  bytes.append(reinterpret_cast<const char*>(records.data()), n * sizeof(T));
}

template <class T>
void take(const std::string& bytes, size_t& at, std::vector<T>& records, const std::filesystem::path& file) {
  std::uint64_t n = 0;
  if (bytes.size() < at + sizeof n) io::cut_short(file);
  std::memcpy(&n, bytes.data() + at, sizeof n);
  at += sizeof n;
  if ((bytes.size() - at) / sizeof(T) < n) io::cut_short(file);
  const size_t before = records.size();
  records.resize(before + n);
  if (n > 0) std::memcpy(records.data() + before, bytes.data() + at, n * sizeof(T));
  at += n * sizeof(T);
}

double number(const core::Value& v, std::string_view key) {
  const core::Value* found = v.find(key);
  return found && found->is_number() ? found->as_number() : std::nan("");
}

}  // namespace

void write_line_cells(const std::filesystem::path& file, const quality::LineCells& cells) {
  std::string bytes;
  append(bytes, cells.differences);
  append(bytes, cells.scatters);
  io::write_text_file(file, bytes);
}

void read_line_cells(const std::filesystem::path& file, quality::LineCells& cells) {
  const std::string bytes = io::read_text_file(file);
  size_t at = 0;
  take(bytes, at, cells.differences, file);
  take(bytes, at, cells.scatters, file);
  if (at != bytes.size()) io::cut_short(file);
}

std::optional<quality::KnownLines> known_lines(const Context& context) {
  const std::filesystem::path file = context.made(file_name);
  if (file.empty()) return std::nullopt;
  const core::Value v = io::read_value_file(file);
  quality::KnownLines out{{}, number(v, "scatter_m"), number(v, "common_m"), number(v, "residual_m"), number(v, "common_horizontal_m")};
  if (const double steep = number(v, "steep_places"); std::isfinite(steep)) out.steep_places = static_cast<int>(steep);
  for (const core::Value& l : v.find("lines")->items())
    out.offsets[static_cast<int>(l.find("line")->as_int())] = l.find("offset_m")->as_number();
  return out;
}

}  // namespace swath::stages
