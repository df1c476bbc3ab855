// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "core/config/result.h"
#include "core/records/gnss_data.h"

namespace swath::core {

/// Fixes by how they were computed.
struct FixCounts {
  std::array<std::uint64_t, Choices<FixQuality>::names.size()> n{};

  void add(FixQuality q) { ++n[static_cast<size_t>(q)]; }
};

template <class V>
void describe(const FixCounts& r, V& v) {
  for (size_t k = 0; k < r.n.size(); ++k) v.result(Choices<FixQuality>::names[k], r.n[k], if_any(), "Fixes of this quality.");
}

}  // namespace swath::core
