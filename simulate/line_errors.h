// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulate/flight.h"
#include "simulate/options.h"

namespace swath::simulate {

/// Errors of the delivered trajectory that belong to a flight line: for each of north, east, up, roll, pitch, heading an offset in the
/// line's middle and a linear change from its start to its end, drawn for each line. Between two lines a polynomial joins the two straight
/// ones (twice continuously differentiable); before the first and after the last the change dies away within some 10 s.
class LineErrors {
 public:
  LineErrors(const NoiseOptions& noise, const std::vector<Line>& lines, std::int64_t seed);

  struct At {
    std::array<double, 6> value{}, rate{};  ///< m, rad; per second
    std::array<double, 6> sigma{};          ///< of the value over all seeds
  };
  At at(double t) const;
  /// Offset in the middle and change over the line, m and rad.
  struct Draw {
    std::array<double, 6> shift{}, drift{};
  };
  const std::vector<Draw>& draws() const { return draws_; }

 private:
  std::vector<Line> lines_;
  std::array<double, 6> shift_{}, drift_{};  // sigmas
  std::vector<Draw> draws_;
};

}  // namespace swath::simulate
