// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/block.h"

#include <algorithm>

namespace swath::core {

void ByteRows::resize(size_t n, size_t least) {
  if (least > width && !bytes.empty()) {
    const size_t rows = size();
    std::vector<std::uint8_t> wide(rows * least);
    for (size_t i = 0; i < rows; ++i) std::copy_n(row(i), width, wide.data() + i * least);
    bytes = std::move(wide);
  }
  width = std::max(width, least);
  bytes.resize(n * width);
}

std::string_view name_of(Column c) {
  std::string_view out = c == Column::source ? "source" : "";
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
  if (!b.source.empty()) out.add(Column::source);
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
  if (present.has(Column::source)) b.source.resize(n, 0);
}

namespace {

/// `n` rows of `from`, that at which(i) as row i, behind the first `before` of `to`; zeros where one side has none.
template <class Which>
void append_rows(ByteRows& to, size_t before, const ByteRows& from, size_t n, Which which) {
  if (to.empty() && from.empty()) return;
  if (to.bytes.capacity() < (before + n) * to.width) to.bytes.reserve(std::max((before + n) * to.width, 2 * to.bytes.capacity()));
  to.resize(before + n, from.width);
  if (from.empty()) return;
  for (size_t i = 0; i < n; ++i) std::copy_n(from.row(which(i)), from.width, to.row(before + i));
}

}  // namespace

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
  append_rows(to.source, before, from.source, from.size(), [](size_t i) { return i; });
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
  append_rows(to.source, before, from.source, rows.size(), [&](size_t i) { return size_t{rows[i]}; });
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
  append_rows(out.source, 0, b.source, rows.size(), [&](size_t i) { return size_t{rows[i]}; });
  return out;
}

}  // namespace swath::core
