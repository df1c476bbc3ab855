// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/area.h"

#include <cmath>
#include <vector>

#include "core/config/units.h"

namespace swath::core {

void leave_out(Block& block, const std::function<bool(size_t)>& is_out, const std::string& what, const std::string& name, Tally& tally) {
  std::vector<std::uint32_t> good;
  const auto number = [](double v) { return format_number(std::round(v * 100.0) / 100.0); };
  for (std::uint32_t i = 0; i < block.size(); ++i) {
    if (!is_out(i)) {
      good.push_back(i);
      continue;
    }
    if (tally.of(what) >= Tally::examples_kept) {  // texts are expensive where most points go
      tally.count(what);
      continue;
    }
    tally.count(what, name + ": record " + std::to_string(block.record.empty() ? i : block.record[i]) + ": x " +
                          number(block.x[i] + block.origin.x()) + ", y " + number(block.y[i] + block.origin.y()) + ", z " +
                          number(block.z[i] + block.origin.z()));
  }
  if (good.size() < block.size()) block = select(block, good);
}

void keep_in_area(const Area& area, Block& block, const std::string& name, Tally& tally) {
  const Box& box = area.box;
  // Both borders are in: a stated area may end where its points do.
  const auto outside = [&](size_t i) {
    const double x = block.x[i] + block.origin.x(), y = block.y[i] + block.origin.y();
    return !(x >= box.x0 && x <= box.x1 && y >= box.y0 && y <= box.y1);
  };
  const auto beyond = [&](size_t i) { return !area.has_height(block.z[i] + block.origin.z()); };
  bool any = false;
  for (size_t i = 0; i < block.size() && !any; ++i) any = outside(i) || beyond(i);
  if (!any) return;
  leave_out(block, outside, "points outside the survey's area, left out", name, tally);
  leave_out(block, beyond, "points outside the survey's heights, left out", name, tally);
}

}  // namespace swath::core
