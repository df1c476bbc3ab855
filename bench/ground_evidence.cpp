// SPDX-License-Identifier: GPL-3.0-or-later
// What filters.ground knows of returns, for bench/accuracy/ground_calibration.py: ground_evidence < POINTS > EVIDENCE.
// In: six doubles per point: easting, northing, height (m), return number, number of returns, strip. Out: the nine floats of
// GroundEvidence.
#include <array>
#include <cstdio>

#include "filters/ground.h"

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
  for (const filters::GroundEvidence& e : filters::ground_evidence(b, b.size(), {})) {
    const std::array<float, 9> row{e.chance, e.above, e.spread, e.lowered, e.narrowed, e.slope, e.standing, e.sunken, e.support};
    if (std::fwrite(row.data(), sizeof row, 1, stdout) != 1) return 1;
  }
  return 0;
}
