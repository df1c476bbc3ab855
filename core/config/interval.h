// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <limits>

#include "core/config/result.h"

namespace swath::core {

/// From the smallest to the largest of the values that were added; as a result a list of both, left out where there is none. NaN is passed
/// over.
struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();

  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  bool any() const { return low <= high; }
};

template <>
struct ResultCodec<Interval> {
  static Shape shape() {
    Shape s{Kind::number};
    s.length = 2;
    return s;
  }
  static Value get(const Interval& i) { return i.any() ? Value(Value::Array{i.low, i.high}) : Value{}; }
};

}  // namespace swath::core
