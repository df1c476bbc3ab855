// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/paste.h"

#include <algorithm>

namespace swath::core {

void paste(const Grid& tile, Grid& window) {
  const Lattice& from = tile.lattice;
  const Lattice& to = window.lattice;
  const std::int64_t i0 = std::max(from.i0, to.i0), i1 = std::min(from.i0 + from.nx, to.i0 + to.nx);
  const std::int64_t j0 = std::max(from.j0, to.j0), j1 = std::min(from.j0 + from.ny, to.j0 + to.ny);
  if (i0 >= i1 || j0 >= j1) return;
  if (!tile.sigma.empty() && window.sigma.empty()) window.sigma.assign(to.size(), std::numeric_limits<float>::quiet_NaN());
  if (!tile.count.empty() && window.count.empty()) window.count.assign(to.size(), 0);
  for (std::int64_t j = j0; j < j1; ++j) {
    const size_t a = from.at(static_cast<int>(i0 - from.i0), static_cast<int>(j - from.j0));
    const size_t b = to.at(static_cast<int>(i0 - to.i0), static_cast<int>(j - to.j0));
    const auto n = static_cast<std::ptrdiff_t>(i1 - i0);
    const auto copy = [&](const auto& source, auto& target) {
      if (!source.empty()) std::copy_n(source.begin() + static_cast<std::ptrdiff_t>(a), n, target.begin() + static_cast<std::ptrdiff_t>(b));
    };
    copy(tile.height, window.height);
    copy(tile.reason, window.reason);
    copy(tile.sigma, window.sigma);
    copy(tile.count, window.count);
  }
}

}  // namespace swath::core
