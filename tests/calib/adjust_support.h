// SPDX-License-Identifier: GPL-3.0-or-later
// Adjustments of a made block.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "calib/adjust/adjust.h"
#include "tests/calib/tie_block.h"

namespace swath::calib::test {

constexpr double arcsec = deg / 3600.0;

inline AdjustOptions plain() {
  AdjustOptions o;
  o.corrections.spacing = core::Seconds(5.0);
  o.jackknife.lines = false;
  o.jackknife.blocks = 0;
  return o;
}

inline World pattern_of(std::vector<FlownLine> lines, int buildings = 12, int returns = 12) {
  World w = make_world(std::move(lines), block_planes(5, buildings, 5));
  w.returns = returns;
  return w;
}

inline bool says(const Adjustment& a, const std::string& text, bool refuses) {
  return std::any_of(a.findings.begin(), a.findings.end(),
                     [&](const Finding& f) { return f.refuses == refuses && f.what.find(text) != std::string::npos; });
}

inline const std::vector<Parameter> usual = {boresight_roll, boresight_pitch, boresight_heading, range_offset, scan_scale};

inline Adjustment flown(const World& w, const AdjustOptions& o, std::uint64_t seed, core::Calibration start) {
  Dice dice(seed);
  const ErrorDraw draw(w, tactical_errors);
  const TieSet ties = ties_of(w, &dice);
  const trajectory::Trajectory t(draw.with_errors(w.exact, dice));
  return adjust(ties, w.scanner, start, w.noise, t, tactical_errors, o);
}

inline core::Calibration near_truth(const World& w) {
  core::Calibration c = w.truth;
  c.roll.value += 0.02 * deg;
  c.pitch.value -= 0.02 * deg;
  return c;
}

}  // namespace swath::calib::test
