// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/known_lines.h"

#include <cmath>

namespace swath::quality {

void take_offsets(core::Block& b, const KnownLines& lines) {
  if (b.strip.empty()) return;
  int line = -1;
  double offset = 0.0;
  for (size_t p = 0; p < b.size(); ++p) {
    if (b.strip[p] != line) {
      line = b.strip[p];
      const auto found = lines.offsets.find(line);
      offset = found == lines.offsets.end() ? 0.0 : found->second;
    }
    b.z[p] -= offset;
  }
}

double KnownLines::shared() const { return std::isnan(common) ? scatter : common; }

double KnownLines::sigma() const { return std::hypot(scatter, shared()); }

double KnownLines::horizontal_sigma() const {
  const double n = std::isnan(common_horizontal) ? 0.0 : steep_places, seen = n > 0.0 ? n * common_horizontal * common_horizontal : 0.0;
  return std::sqrt(2.0 * (seen + shared() * shared()) / (n + 1.0));
}

std::uint64_t give_sigmas(core::Block& b, double vertical, double horizontal) {
  std::uint64_t given = 0;
  core::add_columns(b, {core::Column::sigma_v, core::Column::sigma_h});
  for (size_t p = 0; p < b.size(); ++p)
    if (b.sigma_v[p] == 0.0F) {
      ++given;
      b.sigma_v[p] = static_cast<float>(vertical);
      if (b.sigma_h[p] == 0.0F) b.sigma_h[p] = static_cast<float>(horizontal);
    }
  return given;
}

}  // namespace swath::quality
