// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/value_file.h"
#include "quality/line_offsets.h"
#include "stages/adapters/adapters.h"
#include "stages/tile.h"

namespace swath::stages {
namespace {

using core::Column;

struct OverlapCounts {
  std::uint64_t overlaps = 0, alone = 0;
};

template <class V>
void describe(const OverlapCounts& r, V& v) {
  v.result("overlaps of two lines", r.overlaps, "Pairs of flight lines that overlap.");
  v.result("lines that overlap no other on smooth ground: no offset", r.alone, core::if_any(), "Flight lines without an offset.");
}

quality::LineCells cells_of_lines(const std::vector<std::filesystem::path>& files) {
  quality::LineCells cells;
  for (const std::filesystem::path& file : files) read_rows(file, cells.differences, cells.scatters);
  return cells;
}
void keep_cells(const std::filesystem::path& folder, TileKey key, const quality::LineCells& cells) {
  write_rows(piece_file(folder, key, "cells"), cells.differences, cells.scatters);
}

void compare_cells(const TileJob& job, const quality::LineOptions& o) {
  keep_cells(job.folder, job.key, quality::compare_cells(job.block, job.own, o));
}
/// Blocks that parts share are the same in each.
void join_cells(const Context&, const TileJob& whole, const std::vector<std::filesystem::path>& parts) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& part : parts) files.push_back(piece_file(part, whole.key, "cells"));
  keep_cells(whole.folder, whole.key, cells_of_lines(files));
}
Found<quality::LineComparison, OverlapCounts> compare_lines(const MergeJob& job, const Output& to, const quality::LineOptions& o) {
  std::vector<std::filesystem::path> files;
  for (const TileKey key : job.tiles) files.push_back(piece_file(job.folder, key, "cells"));
  quality::LineComparison found = quality::compare_lines(cells_of_lines(files), o);
  io::write_text_file(to.folder / "lines.json", io::to_json(core::reported(found)));
  OverlapCounts counts{found.pairs.size()};
  for (const quality::LineOffset& line : found.lines) counts.alone += line.pairs == 0;
  return {std::move(found), counts};
}

}  // namespace

Entry lines_stage() {
  return tile<compare_cells, compare_lines>(
      "quality.lines", "Flight lines compared where they overlap: a height offset per line, scatter of the returns, what neighbours share.",
      {.columns = {.needs = {Column::strip, Column::flags}, .reads = {Column::classification, Column::return_number, Column::return_count}},
       .memory = [](const quality::LineOptions&, const Context&) { return TileMemory{48.0}; },
       .products = [](const quality::LineOptions&) { return std::vector<std::string>{"lines.json"}; },
       .join_parts = join_cells});
}

}  // namespace swath::stages
