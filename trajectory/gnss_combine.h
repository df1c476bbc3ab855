// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/config/result.h"
#include "core/records/gnss_data.h"
#include "core/time.h"

namespace swath::trajectory {

/// What a list of fixes is worth, measured on the rover's own epochs.
struct GnssAccount {
  std::uint64_t fixes = 0;
  std::array<std::uint64_t, 7> by_quality{};  ///< as core::FixQuality
  double first = 0, last = 0;                 ///< GPS time, s
  std::uint64_t gaps = 0;                     ///< steps of more than 1.5 intervals
  double longest_gap = 0;                     ///< s
  double longest_gap_at = 0;                  ///< GPS time at its begin

  double share(core::FixQuality q) const {
    return fixes ? static_cast<double>(by_quality[static_cast<size_t>(q)]) / static_cast<double>(fixes) : 0.0;
  }
};

template <class V>
void describe(const GnssAccount& r, V& v) {
  using core::FixQuality;
  const auto known = [&r](core::Form f) { return f.only_if(r.fixes > 0); };
  v.result("epochs", r.fixes, known(core::plain().in_summary()), "Epochs with a fix.");
  for (size_t q = 0; q < r.by_quality.size(); ++q) {
    const bool always = q == static_cast<size_t>(FixQuality::fixed) || q == static_cast<size_t>(FixQuality::float_ambiguity);
    v.result(core::Choices<FixQuality>::names[q], r.by_quality[q], always ? known(core::plain()) : core::if_any(),
             "Fixes of this quality.");
  }
  v.result("fixed_percent", 100 * r.share(FixQuality::fixed), known(core::percent().in_summary()), "Share of the epochs that are fixed.");
  v.result("first", core::utc_text(r.first), known(core::plain()), "UTC of the first fix.");
  v.result("last", core::utc_text(r.last), known(core::plain()), "UTC of the last fix.");
  v.result("gaps", r.gaps, known(core::plain()), "Steps of more than 1.5 intervals.");
  v.result("longest_gap_s", r.longest_gap, known(core::seconds(1)), "Longest step between fixes.");
}

/// `interval`: the usual step between epochs, s.
GnssAccount account_of(const core::GnssData& fixes, double interval);

/// Several solutions of one rover, from several bases, as one.
struct CombinedGnss {
  core::GnssData data;
  std::vector<std::uint64_t> taken;  ///< by solution: epochs at which it is the one taken, or the first of those averaged
  std::uint64_t averaged = 0;        ///< epochs that are means of several fixed solutions
  std::uint64_t disagreeing = 0;     ///< epochs at which fixed solutions disagreed
  double worst_disagreement = 0;     ///< greatest distance of two of them, m
  double worst_at = 0;               ///< GPS time
};

/// By epoch the best quality is taken; of several fixed solutions the largest group that agrees (the nearest base's where groups are
/// equal). `solutions` are sorted, nearest base first; those of one epoch lie within 1 ms. Two fixed solutions agree where their
/// difference lies within `sigmas` of the sum of their covariances (Mahalanobis distance, 3 dimensions). A group's mean is weighted by
/// inverse covariances; its covariance is what covariance intersection with equal weights gives, which holds whatever the correlation:
/// solutions of one receiver share its multipath and noise (Julier and Uhlmann 1997). Where no group is larger than the others, half of
/// the squared difference to the nearest one outside is added to the covariance: either may be the wrong one.
CombinedGnss combine_gnss(const std::vector<core::GnssData>& solutions, double sigmas);

}  // namespace swath::trajectory
