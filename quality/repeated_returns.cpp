// SPDX-License-Identifier: GPL-3.0-or-later
// Deviation: coordinates are compared after rounding. Returns whose coordinates differ by rounding errors (1e-9 m) are missed where these
// lie on both sides of a border: 3 in 100 000 where the coordinates follow no decimal scale, none where they do.
#include "quality/repeated_returns.h"

#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include "quality/known_time.h"
#include "quality/pulse_density.h"

namespace swath::quality {
namespace {

constexpr double steps = 8192.0;  // per metre: borders of a binary step lie on no multiple of a decimal scale
constexpr std::uint32_t free_slot = std::numeric_limits<std::uint32_t>::max();

class RecordedReturns {
 public:
  explicit RecordedReturns(const core::Block& b) : b_(b) {}

  bool is_same(std::size_t p, std::size_t q) const {
    if (!has_same(b_.return_number, p, q) || time(p) != time(q)) return false;
    for (const auto* axis : {&b_.x, &b_.y, &b_.z})
      if (step((*axis)[p]) != step((*axis)[q])) return false;
    return time(p) != 0.0 ||
           (has_same(b_.intensity, p, q) && has_same(b_.return_count, p, q) && has_same(b_.scan_angle, p, q) && has_same(b_.red, p, q) &&
            has_same(b_.green, p, q) && has_same(b_.blue, p, q) && has_same(b_.user_data, p, q));
  }
  std::uint64_t hash(std::size_t p) const {
    std::uint64_t h = std::bit_cast<std::uint64_t>(time(p));
    for (const auto* axis : {&b_.x, &b_.y, &b_.z}) h = mixed(h ^ static_cast<std::uint64_t>(step((*axis)[p])));
    return time(p) == 0.0 && !b_.intensity.empty() ? mixed(h ^ b_.intensity[p]) : h;
  }
  bool goes_before(std::size_t p, std::size_t q) const {
    const auto rank = [&](std::size_t i) { return std::tuple(b_.strip.empty() ? 0 : b_.strip[i], b_.x[i], b_.y[i]); };
    return rank(p) < rank(q);
  }

 private:
  /// 0: not known.
  double time(std::size_t p) const { return b_.time.empty() || !is_known_time(b_.time[p]) ? 0.0 : b_.time[p]; }
  static std::int64_t step(double v) { return std::llround(v * steps); }
  /// Finalizer of SplitMix64.
  static std::uint64_t mixed(std::uint64_t h) {
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ULL;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebULL;
    return h ^ (h >> 31);
  }
  template <class T>
  static bool has_same(const std::vector<T>& column, std::size_t p, std::size_t q) {
    return column.empty() || column[p] == column[q];
  }

  const core::Block& b_;
};

}  // namespace

std::vector<std::uint8_t> repeated_first_returns(const core::Block& block) {
  std::vector<std::uint8_t> out;
  const RecordedReturns returns(block);
  std::vector<std::uint32_t> slots(std::bit_ceil(2 * block.size() + 1), free_slot);
  const std::size_t mask = slots.size() - 1;
  for (std::size_t p = 0; p < block.size(); ++p) {
    if (!is_first(block, p)) continue;
    std::size_t s = returns.hash(p) & mask;
    while (slots[s] != free_slot && !returns.is_same(slots[s], p)) s = (s + 1) & mask;
    const auto row = static_cast<std::uint32_t>(p);
    if (slots[s] == free_slot) {
      slots[s] = row;
      continue;
    }
    out.resize(block.size(), 0);
    const bool keeps_new = returns.goes_before(p, slots[s]);
    out[keeps_new ? slots[s] : row] = 1;
    if (keeps_new) slots[s] = row;
  }
  return out;
}

}  // namespace swath::quality
