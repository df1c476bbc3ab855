// SPDX-License-Identifier: GPL-3.0-or-later
// What a tile leaves in a stage's folder, for other stages and for the merge: grids, and rows of records.
#pragma once

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "core/grid.h"
#include "io/raster/grid_file.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "stages/stage.h"

namespace swath::stages {

/// "3_-2.shores": the file of a tile in a stage's folder.
std::filesystem::path piece_file(const std::filesystem::path& folder, TileKey key, const char* ending);
inline std::filesystem::path grid_file(const std::filesystem::path& folder, TileKey key) { return piece_file(folder, key, "grid"); }

void write_grid_tile(const std::filesystem::path& folder, TileKey key, const core::Grid& grid);

/// The grid that a tile's parts made under the tile's key in folders of their own, as the tile's; nothing where none made one.
void join_grid_parts(const std::filesystem::path& folder, TileKey key, const std::vector<std::filesystem::path>& parts,
                     const core::Lattice& lattice);

/// Rows of some kinds as they lie in memory, each kind after its number.
template <class... Row>
void write_rows(const std::filesystem::path& file, const std::vector<Row>&... rows) {
  static_assert((std::is_trivially_copyable_v<Row> && ...));
  std::string bytes;
  const auto append = [&bytes](const auto& of_a_kind) {
    const std::uint64_t n = of_a_kind.size();
    bytes.append(reinterpret_cast<const char*>(&n), sizeof n);
    bytes.append(reinterpret_cast<const char*>(of_a_kind.data()), n * sizeof(of_a_kind[0]));
  };
  (append(rows), ...);
  io::write_text_file(file, bytes);
}

/// Appends them to `rows`; throws core::Error where the file is damaged.
template <class... Row>
void read_rows(const std::filesystem::path& file, std::vector<Row>&... rows) {
  static_assert((std::is_trivially_copyable_v<Row> && ...));
  const std::string bytes = io::read_text_file(file);
  size_t at = 0;
  const auto take = [&](auto& of_a_kind) {
    std::uint64_t n = 0;
    if (bytes.size() < at + sizeof n) io::cut_short(file);
    std::memcpy(&n, bytes.data() + at, sizeof n);
    at += sizeof n;
    if ((bytes.size() - at) / sizeof(of_a_kind[0]) < n) io::cut_short(file);
    const size_t before = of_a_kind.size(), size = n * sizeof(of_a_kind[0]);
    of_a_kind.resize(before + n);
    if (n > 0) std::memcpy(of_a_kind.data() + before, bytes.data() + at, size);
    at += size;
  };
  (take(rows), ...);
  if (at != bytes.size()) io::cut_short(file);
}

}  // namespace swath::stages
