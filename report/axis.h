// SPDX-License-Identifier: GPL-3.0-or-later
// One axis of a chart: its range, round ticks and its label.
#pragma once

#include <string>
#include <vector>

namespace swath::report {

struct Tick {
  double value = 0.0;  ///< in the data's unit
  std::string text;    ///< without the offset that the label names
};

struct Axis {
  double low = 0.0, high = 1.0;  ///< low < high
  bool log = false;              ///< both ends are above zero
  std::string label;
  std::vector<Tick> ticks;  ///< rising, within [low, high]
  /// Where a value lies along the axis: 0 at low, 1 at high; NaN for what a logarithmic axis cannot hold.
  double share(double value) const;
};

/// Spans of a row of finite numbers; empty() until one was added.
struct Reach {
  double low = 0.0, high = 0.0;
  bool any = false;
  bool empty() const { return !any; }
  /// Passes over NaN and infinite values, and over values <= 0 where only `positive` ones count.
  void add(double v, bool positive = false);
};

/// The axis over a reach, grown by `margin` (share of its length) on both sides; an empty one becomes 0 to 1, one without length gets some.
/// `most`: number of ticks that have room. Ticks are 1, 2 or 5 times a power of ten apart; on a logarithmic axis powers of ten, with 2 and
/// 5 times them where there are few. Values that would need six or more digits to distinguish one tick from the next are shown relative to
/// a round offset, which the label then names: "time (s)" becomes "time since 474000 s (s)", "northing (m)" "northing from 5321000 m (m)".
Axis make_axis(const Reach& reach, const std::string& label, int most, double margin, bool log = false);

}  // namespace swath::report
