// SPDX-License-Identifier: GPL-3.0-or-later
// Returns of a pulse: which is first and last, repair of their numbers, statistics, penetration.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/block.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "core/grid.h"

namespace swath::filters {

/// What to do with a pulse of which some returns are absent (numbers 1 and 3 of 3).
enum class Gaps { renumber, keep };

struct ReturnsOptions {
  Gaps gaps = Gaps::renumber;
};

template <class V>
void describe(ReturnsOptions& o, V& v) {
  v.option("gaps", o.gaps, "Pulses with absent returns: renumber those present, or keep the numbers and flag them.");
}

/// Most returns of one pulse (LAS 1.4 R15: four bits); a larger group under one time is no pulse.
constexpr int most_returns = 15;

/// Unknown numbers (0) count as the only return.
inline bool is_first_return(const core::Block& b, size_t p) { return b.return_number.empty() || b.return_number[p] <= 1; }
inline bool is_only_return(const core::Block& b, size_t p) { return is_first_return(b, p) && core::is_last_return(b, p); }
inline bool is_intermediate_return(const core::Block& b, size_t p) { return !is_first_return(b, p) && !core::is_last_return(b, p); }

/// Row after the last of the pulse that starts at `begin`: adjacent rows of one strip and one time. Without times every row is a pulse.
size_t end_of_pulse(const core::Block& b, size_t begin);

/// Do the times distinguish the pulses? Not where points have none, and not where they are so coarse that pulses share them: more rows
/// under one time than a pulse has returns, or two first returns, in more than one of a hundred.
bool tells_pulses(const core::Block& b);

struct RepairCounts {
  std::uint64_t pulses = 0, repaired_pulses = 0, inconsistent_pulses = 0;
  std::uint64_t repaired = 0, inconsistent = 0;  ///< returns
  bool operator==(const RepairCounts&) const = default;
};

/// Repairs return numbers and counts, pulse by pulse; adds the columns where they are missing. A pulse of n returns is sound where its
/// numbers are 1 ... n, each once, all counts are n, and ranges (where the block has them) grow with the number. Any other pulse is
/// numbered anew: by range where all ranges are positive and different; without a range column by the numbers where these are different,
/// else in the order of the rows. Its changed returns get flag returns_repaired. A pulse that cannot be repaired (range missing or twice
/// the same, more than 15 returns, no times to distinguish pulses, gaps that are to be kept) keeps its numbers, and its returns get flag
/// returns_inconsistent. The block must begin and end on borders of pulses.
RepairCounts repair_returns(core::Block& b, const ReturnsOptions& o);

/// Returns of one flight line.
struct StripReturns {
  std::array<std::uint64_t, most_returns + 1> pulses{};           ///< by number of returns; larger ones in the last
  std::uint64_t first = 0, last = 0, intermediate = 0, only = 0;  ///< returns; an only return counts as first and as last, too
};

template <class V>
void describe(const StripReturns& r, V& v) {
  v.result("first returns", r.first, "First returns of their pulses; an only return is among them.");
  v.result("last returns", r.last, "Last returns of their pulses; an only return is among them.");
  v.result("only returns", r.only, "Returns that are alone in their pulse.");
  v.result("intermediate returns", r.intermediate, core::if_any(), "Returns between the first and the last.");
  for (size_t k = 1; k < r.pulses.size(); ++k)
    v.result("pulses of " + std::to_string(k) + (k == 1 ? " return" : " returns"), r.pulses[k], core::if_any(),
             "Pulses with so many returns.");
}

/// Adds the returns of a block to those of their flight lines. The block must begin and end on borders of pulses.
void count_returns(const core::Block& b, std::map<std::uint16_t, StripReturns>& lines);

/// Pulses by cell; a pulse belongs to the cell of its last return.
struct Penetration {
  core::Lattice lattice;
  std::vector<std::uint32_t> pulses, ground_pulses;
  std::vector<std::uint32_t> returns;  ///< usable returns of any number

  /// Ground pulses / pulses, 0 to 1; NaN where there is no pulse.
  double rate(size_t cell) const;
};

/// Counts the usable last returns of the first `own` points on the lattice, and those of class ground (Brandalize: about 0.30 under
/// conifers, 0.65 in mixed wood). Points outside the lattice are left out. Needs no halo.
Penetration penetration(const core::Block& b, size_t own, const core::Lattice& lattice);

}  // namespace swath::filters

template <>
struct swath::core::Choices<swath::filters::Gaps> {
  static constexpr std::array<std::string_view, 2> names{"renumber", "keep"};
};
