// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/buildings/regions.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <tuple>

namespace swath::terrain {

std::vector<CellRun> runs_of(std::vector<CellPlace> cells) {
  std::sort(cells.begin(), cells.end(), [](const CellPlace& a, const CellPlace& b) { return std::tie(a.j, a.i) < std::tie(b.j, b.i); });
  std::vector<CellRun> out;
  for (const CellPlace& c : cells) {
    if (!out.empty() && out.back().j == c.j && c.i <= out.back().last + 1)
      out.back().last = c.i;
    else
      out.push_back({c.j, c.i, c.i});
  }
  return out;
}

CellSet::CellSet(const std::vector<CellRun>& runs) {
  for (const CellRun& r : runs) rows_[r.j].push_back({r.first, r.last, 0});
  for (auto& [j, row] : rows_) {
    std::sort(row.begin(), row.end(), [](const Piece& a, const Piece& b) { return a.first < b.first; });
    std::vector<Piece> joined;
    for (const Piece& p : row) {
      if (!joined.empty() && p.first <= joined.back().last + 1)
        joined.back().last = std::max(joined.back().last, p.last);
      else
        joined.push_back(p);
    }
    row = std::move(joined);
  }
  find_groups();
}

/// Pieces of two rows that touch are joined; the root of a group is its first piece.
void CellSet::find_groups() {
  std::uint32_t pieces = 0;
  for (auto& [j, row] : rows_)
    for (Piece& p : row) p.group = pieces++;
  std::vector<std::uint32_t> root(pieces);
  std::iota(root.begin(), root.end(), 0u);
  const auto top = [&](std::uint32_t p) {
    while (root[p] != p) p = root[p] = root[root[p]];
    return p;
  };
  for (auto row = rows_.begin(); row != rows_.end(); ++row) {
    const auto above = std::next(row);
    if (above == rows_.end() || above->first != row->first + 1) continue;
    size_t k = 0;
    for (const Piece& p : row->second) {
      while (k < above->second.size() && above->second[k].last + 1 < p.first) ++k;
      for (size_t n = k; n < above->second.size() && above->second[n].first <= p.last + 1; ++n) {
        const std::uint32_t a = top(p.group), b = top(above->second[n].group);
        root[std::max(a, b)] = std::min(a, b);
      }
    }
  }
  std::vector<std::uint32_t> number(pieces);
  std::uint32_t next = 0;
  for (std::uint32_t p = 0; p < pieces; ++p) number[p] = top(p) == p ? next++ : number[top(p)];
  for (auto& [j, row] : rows_)
    for (Piece& p : row) p.group = number[p.group];
  groups_ = next;
}

const CellSet::Piece* CellSet::find(std::int64_t i, std::int64_t j) const {
  const auto row = rows_.find(j);
  if (row == rows_.end()) return nullptr;
  const auto after =
      std::upper_bound(row->second.begin(), row->second.end(), i, [](std::int64_t v, const Piece& p) { return v < p.first; });
  if (after == row->second.begin()) return nullptr;
  const Piece& p = *std::prev(after);
  return i <= p.last ? &p : nullptr;
}

bool CellSet::holds(std::int64_t i, std::int64_t j) const { return find(i, j) != nullptr; }

std::uint32_t CellSet::group(std::int64_t i, std::int64_t j) const { return find(i, j)->group; }

}  // namespace swath::terrain
