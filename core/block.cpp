// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/block.h"

#include <algorithm>

namespace swath::core {

std::string_view name_of(Column c) {
  std::string_view out;
  for_each_column([&](Column column, std::string_view name, auto) {
    if (column == c) out = name;
  });
  return out;
}

ColumnSet columns_of(const Block& b) {
  ColumnSet out;
  for_each_column([&](Column c, std::string_view, auto member) {
    if (c == Column::x || c == Column::y || c == Column::z || !(b.*member).empty()) out.add(c);
  });
  return out;
}

void add_columns(Block& b, ColumnSet columns) {
  for_each_column([&](Column c, std::string_view, auto member) {
    if (columns.has(c)) (b.*member).resize(b.size());
  });
}

void resize(Block& b, size_t n) {
  const ColumnSet present = columns_of(b);
  for_each_column([&](Column c, std::string_view, auto member) {
    if (present.has(c)) (b.*member).resize(n);
  });
}

void append(Block& to, const Block& from) {
  const size_t before = to.size();
  const size_t total = before + from.size();
  for_each_column([&](Column, std::string_view, auto member) {
    auto& a = to.*member;
    const auto& b = from.*member;
    if ((before > 0 && a.empty()) && b.empty()) return;
    if (before == 0 && b.empty()) return;
    a.resize(before);
    a.insert(a.end(), b.begin(), b.end());
    a.resize(total);
  });
}

void append(Block& to, const Block& from, const std::vector<std::uint32_t>& rows) {
  const size_t before = to.size();
  const size_t total = before + rows.size();
  for_each_column([&](Column, std::string_view, auto member) {
    auto& a = to.*member;
    const auto& b = from.*member;
    if (a.empty() && b.empty()) return;
    if (a.capacity() < total) a.reserve(std::max(total, 2 * a.capacity()));
    a.resize(total);
    if (b.empty()) return;
    for (size_t i = 0; i < rows.size(); ++i) a[before + i] = b[rows[i]];
  });
}

Block select(const Block& b, const std::vector<std::uint32_t>& rows) {
  Block out;
  out.origin = b.origin;
  for_each_column([&](Column, std::string_view, auto member) {
    const auto& from = b.*member;
    if (from.empty()) return;
    auto& to = out.*member;
    to.reserve(rows.size());
    for (const std::uint32_t i : rows) to.push_back(from[i]);
  });
  return out;
}

}  // namespace swath::core
