// SPDX-License-Identifier: GPL-3.0-or-later
// What filters.ground knows of returns, for bench/accuracy/ground_calibration.py: ground_evidence < POINTS > EVIDENCE.
// In: six doubles per point: easting, northing, height (m), return number, number of returns, strip. Out: above (m, NaN where not judged),
// chance, probability, and the terms of the regression, as floats.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "filters/ground/ground.h"

int main() {
  using namespace swath;
  core::Block b;
  core::add_columns(b, {core::Column::return_number, core::Column::return_count, core::Column::flags, core::Column::strip});
  for (std::array<double, 6> row{}; std::fread(row.data(), sizeof row, 1, stdin) == 1;) {
    if (b.x.empty()) b.origin = {row[0], row[1], 0.0};
    b.x.push_back(row[0] - b.origin.x());
    b.y.push_back(row[1] - b.origin.y());
    b.z.push_back(row[2]);
    b.return_number.push_back(static_cast<std::uint8_t>(row[3]));
    b.return_count.push_back(static_cast<std::uint8_t>(row[4]));
    b.flags.push_back(0);
    b.strip.push_back(static_cast<std::uint16_t>(row[5]));
  }
  const filters::GroundOptions options;
  for (const filters::GroundEvidence& e : filters::ground_evidence(b, b.size(), options)) {
    std::array<float, filters::ground_terms + 3> row{e.above, e.chance, filters::ground_probability(e, options.noise.value, options.grass)};
    if (!std::isnan(e.above)) std::ranges::copy(filters::terms_of(e, options.noise.value), row.begin() + 3);
    if (std::fwrite(row.data(), sizeof row, 1, stdout) != 1) return 1;
  }
  return 0;
}
