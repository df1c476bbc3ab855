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
void put(std::string& bytes, const std::vector<T>& records) {
  const std::uint64_t n = records.size();
  bytes.append(reinterpret_cast<const char*>(&n), sizeof n);
  bytes.append(reinterpret_cast<const char*>(records.data()), n * sizeof(T));
}

template <class T>
void take(const std::string& bytes, size_t& at, std::vector<T>& records, const std::filesystem::path& file) {
  std::uint64_t n = 0;
  if (bytes.size() < at + sizeof n) cut_short(file);
  std::memcpy(&n, bytes.data() + at, sizeof n);
  at += sizeof n;
  if ((bytes.size() - at) / sizeof(T) < n) cut_short(file);
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
  put(bytes, cells.differences);
  put(bytes, cells.scatters);
  io::write_text_file(file, bytes);
}

void read_line_cells(const std::filesystem::path& file, quality::LineCells& cells) {
  const std::string bytes = io::read_text_file(file);
  size_t at = 0;
  take(bytes, at, cells.differences, file);
  take(bytes, at, cells.scatters, file);
  if (at != bytes.size()) cut_short(file);
}

std::optional<KnownLines> known_lines(const Context& context) {
  const std::filesystem::path file = context.made(file_name);
  if (file.empty()) return std::nullopt;
  const core::Value v = io::read_value_file(file);
  KnownLines out{{}, number(v, "scatter_m"), number(v, "common_m"), number(v, "residual_m"), number(v, "common_horizontal_m")};
  if (const double steep = number(v, "steep_places"); std::isfinite(steep)) out.steep_places = static_cast<int>(steep);
  for (const core::Value& l : v.find("lines")->items())
    out.offsets[static_cast<int>(l.find("line")->as_int())] = l.find("offset_m")->as_number();
  return out;
}

void take_offsets(core::Block& b, const KnownLines& lines) {
  if (b.strip.empty()) return;
  int line = -1;
  double offset = 0.0;
  for (size_t p = 0; p < b.size(); ++p) {
    if (b.strip[p] != line) {
      line = b.strip[p];
      const auto found = lines.offsets.find(line);
      offset = found == lines.offsets.end() ? 0.0 : found->second;
    }
    b.z[p] -= offset;
  }
}

double KnownLines::shared() const { return std::isnan(common) ? scatter : common; }

double KnownLines::sigma() const { return std::hypot(scatter, shared()); }

double KnownLines::horizontal_sigma() const {
  const double n = std::isnan(common_horizontal) ? 0.0 : steep_places, seen = n > 0.0 ? n * common_horizontal * common_horizontal : 0.0;
  return std::sqrt(2.0 * (seen + shared() * shared()) / (n + 1.0));
}

std::uint64_t give_sigmas(core::Block& b, double vertical, double horizontal) {
  std::uint64_t given = 0;
  core::add_columns(b, {core::Column::sigma_v, core::Column::sigma_h});
  for (size_t p = 0; p < b.size(); ++p)
    if (b.sigma_v[p] == 0.0F) {
      ++given;
      b.sigma_v[p] = static_cast<float>(vertical);
      if (b.sigma_h[p] == 0.0F) b.sigma_h[p] = static_cast<float>(horizontal);
    }
  return given;
}

}  // namespace swath::stages
