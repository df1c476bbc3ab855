// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/config/result.h"

namespace swath::core {

/// How many there are of a number: of a class, a flight line, a return.
struct NumberCount {
  int number = 0;
  std::uint64_t count = 0;
};
template <class V>
void describe(const NumberCount& r, V& v) {
  v.result("number", r.number, "Class, flight line or number of a return.");
  v.result("count", r.count, "Points or pulses of it.");
}
inline std::vector<NumberCount> counts_of(const std::map<int, std::uint64_t>& counts) {
  std::vector<NumberCount> out;
  for (const auto& [number, count] : counts) out.push_back({number, count});
  return out;
}

}  // namespace swath::core
