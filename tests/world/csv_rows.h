// SPDX-License-Identifier: GPL-3.0-or-later
// A table of a simulated survey with its rows changed.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace swath::test {

/// The table `csv` after `edit(row, cells)` of each of its lines; row 0 is the header. No cell holds a delimiter.
template <class Edit>
std::string with_rows(const std::string& csv, Edit edit) {
  std::istringstream in(csv);
  std::string line, out;
  for (int row = 0; std::getline(in, line); ++row) {
    std::vector<std::string> cells;
    std::istringstream fields(line);
    for (std::string cell; std::getline(fields, cell, ',');) cells.push_back(cell);
    edit(row, cells);
    for (size_t c = 0; c < cells.size(); ++c) out += (c ? "," : "") + cells[c];
    out += "\n";
  }
  return out;
}

}  // namespace swath::test
