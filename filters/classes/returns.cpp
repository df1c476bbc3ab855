// SPDX-License-Identifier: GPL-3.0-or-later
// Meaning of return number and count: ASPRS LAS 1.4 R15, 2.5 (numbers start at 1 with the return nearest to the sensor).
// Penetration rate: Brandalize, airborne laser profiling: ground pulses / pulses.
#include "filters/classes/returns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace swath::filters {
namespace {

struct Pulse {
  size_t begin, end;
  size_t size() const { return end - begin; }
};

bool numbers_differ(const core::Block& b, Pulse p) {
  std::array<bool, 256> seen{};
  for (size_t i = p.begin; i < p.end; ++i) {
    if (b.return_number[i] == 0 || seen[b.return_number[i]]) return false;
    seen[b.return_number[i]] = true;
  }
  return true;
}

bool ranges_differ(const core::Block& b, Pulse p) {
  std::vector<float> ranges(b.range.begin() + static_cast<std::ptrdiff_t>(p.begin), b.range.begin() + static_cast<std::ptrdiff_t>(p.end));
  if (!std::all_of(ranges.begin(), ranges.end(), [](float r) { return std::isfinite(r) && r > 0; })) return false;
  std::sort(ranges.begin(), ranges.end());
  return std::adjacent_find(ranges.begin(), ranges.end()) == ranges.end();
}

bool ranges_grow(const core::Block& b, Pulse p) {
  for (size_t i = p.begin; i < p.end; ++i)
    for (size_t k = p.begin; k < p.end; ++k)
      if (b.return_number[i] < b.return_number[k] && b.range[i] >= b.range[k]) return false;
  return true;
}

bool counts_are(const core::Block& b, Pulse p, size_t count) {
  return std::all_of(b.return_count.begin() + static_cast<std::ptrdiff_t>(p.begin),
                     b.return_count.begin() + static_cast<std::ptrdiff_t>(p.end), [count](std::uint8_t c) { return c == count; });
}

bool numbers_within_counts(const core::Block& b, Pulse p) {
  for (size_t i = p.begin; i < p.end; ++i)
    if (b.return_number[i] > b.return_count[i]) return false;
  return true;
}

bool has_ranges(const core::Block& b) { return b.range.size() == b.size(); }

bool order_agrees(const core::Block& b, Pulse p) { return numbers_differ(b, p) && (!has_ranges(b) || p.size() == 1 || ranges_grow(b, p)); }

bool is_sound(const core::Block& b, Pulse p) {
  return p.size() <= most_returns && order_agrees(b, p) && numbers_within_counts(b, p) && counts_are(b, p, p.size());
}

/// Numbers and counts agree with one another, and some of the pulse's returns are not there.
bool has_gap_only(const core::Block& b, Pulse p) {
  const std::uint8_t count = b.return_count[p.begin];
  return count > p.size() && counts_are(b, p, count) && numbers_within_counts(b, p) && order_agrees(b, p);
}

/// The pulse's rows from its first return to its last; empty where that cannot be determined.
std::vector<size_t> order_of(const core::Block& b, Pulse p) {
  std::vector<size_t> rows(p.size());
  std::iota(rows.begin(), rows.end(), p.begin);
  if (has_ranges(b)) {
    if (p.size() > 1 && !ranges_differ(b, p)) return {};
    std::sort(rows.begin(), rows.end(), [&](size_t i, size_t k) { return b.range[i] < b.range[k]; });
  } else if (numbers_differ(b, p)) {
    std::sort(rows.begin(), rows.end(), [&](size_t i, size_t k) { return b.return_number[i] < b.return_number[k]; });
  }
  return rows;
}

void set_flag(core::Block& b, size_t i, std::uint16_t f) { b.flags[i] = static_cast<std::uint16_t>(b.flags[i] | f); }

}  // namespace

size_t end_of_pulse(const core::Block& b, size_t begin) {
  size_t end = begin + 1;
  if (b.time.size() != b.size()) return end;
  while (end < b.size() && b.time[end] == b.time[begin] && (b.strip.empty() || b.strip[end] == b.strip[begin])) ++end;
  return end;
}

bool tells_pulses(const core::Block& b) {
  if (b.time.size() != b.size() || b.size() == 0) return false;
  if (b.size() > 1 && std::all_of(b.time.begin(), b.time.end(), [&](double t) { return t == b.time[0]; })) return false;
  size_t groups = 0, shared = 0;
  for (size_t begin = 0, end = 0; begin < b.size(); begin = end) {
    end = end_of_pulse(b, begin);
    ++groups;
    size_t first = 0;
    for (size_t i = begin; i < end && !b.return_number.empty(); ++i) first += b.return_number[i] == 1;
    shared += end - begin > most_returns || first > 1;
  }
  return shared * 100 <= groups;
}

RepairCounts repair_returns(core::Block& b, const ReturnsOptions& o) {
  core::add_columns(b, {core::Column::return_number, core::Column::return_count, core::Column::flags});
  RepairCounts n;
  const bool pulses_known = b.time.size() == b.size();
  for (Pulse p{0, 0}; p.begin < b.size(); p.begin = p.end) {
    p.end = end_of_pulse(b, p.begin);
    ++n.pulses;
    const bool sound = pulses_known ? is_sound(b, p) : b.return_number[p.begin] > 0 && numbers_within_counts(b, p);
    if (sound) continue;
    const bool mendable = pulses_known && p.size() <= most_returns && !(o.gaps == Gaps::keep && has_gap_only(b, p));
    const std::vector<size_t> order = mendable ? order_of(b, p) : std::vector<size_t>{};
    if (order.empty()) {
      ++n.inconsistent_pulses;
      n.inconsistent += p.size();
      for (size_t i = p.begin; i < p.end; ++i) set_flag(b, i, core::flag::returns_inconsistent);
      continue;
    }
    ++n.repaired_pulses;
    const auto count = static_cast<std::uint8_t>(p.size());
    for (std::uint8_t k = 0; k < count; ++k) {
      const size_t i = order[k];
      const auto number = static_cast<std::uint8_t>(k + 1);
      if (b.return_number[i] == number && b.return_count[i] == count) continue;
      b.return_number[i] = number;
      b.return_count[i] = count;
      set_flag(b, i, core::flag::returns_repaired);
      ++n.repaired;
    }
  }
  return n;
}

void count_returns(const core::Block& b, std::map<std::uint16_t, StripReturns>& lines) {
  for (size_t begin = 0, end = 0; begin < b.size(); begin = end) {
    end = end_of_pulse(b, begin);
    StripReturns& s = lines[b.strip.empty() ? std::uint16_t{0} : b.strip[begin]];
    ++s.pulses[std::min<size_t>(end - begin, most_returns)];
    for (size_t i = begin; i < end; ++i) {
      s.first += is_first_return(b, i);
      s.last += core::is_last_return(b, i);
      s.intermediate += is_intermediate_return(b, i);
      s.only += is_only_return(b, i);
    }
  }
}

double Penetration::rate(size_t cell) const {
  return pulses[cell] == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(ground_pulses[cell]) / pulses[cell];
}

Penetration penetration(const core::Block& b, size_t own, const core::Lattice& l) {
  const std::vector<std::uint32_t> none(l.size(), 0);
  Penetration out{l, none, none, none};
  for (size_t p = 0; p < own; ++p) {
    if (!core::is_usable(b, p)) continue;
    const std::int64_t i = core::cell_index(b.origin.x() + b.x[p], l.cell) - l.i0;
    const std::int64_t j = core::cell_index(b.origin.y() + b.y[p], l.cell) - l.j0;
    if (i < 0 || j < 0 || i >= l.nx || j >= l.ny) continue;
    const size_t c = l.at(static_cast<int>(i), static_cast<int>(j));
    ++out.returns[c];
    if (!core::is_last_return(b, p)) continue;
    ++out.pulses[c];
    out.ground_pulses[c] += !b.classification.empty() && b.classification[p] == core::point_class::ground;
  }
  return out;
}

}  // namespace swath::filters
