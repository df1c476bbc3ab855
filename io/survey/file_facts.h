// SPDX-License-Identifier: GPL-3.0-or-later
// What `swath info` says of files of several kinds.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/config/interval.h"
#include "core/geo/crs.h"

namespace swath::io {

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

/// The CRS that a file states.
struct StatedCrs {
  std::optional<std::string> name{}, unit{}, heights{};
  int epsg = 0;

  StatedCrs() = default;
  explicit StatedCrs(const core::Crs& c) : name(c.name()), unit(c.unit_name()), heights(c.vertical_name()), epsg(c.epsg()) {}
};
template <class V>
void describe(const StatedCrs& r, V& v) {
  v.result("crs", r.name, "Name of the CRS.");
  v.result("epsg", r.epsg, core::if_any(), "Its EPSG code.");
  v.result("unit", r.unit, "Its horizontal unit.");
  v.result("heights", r.heights, "Vertical reference of the heights.");
}

}  // namespace swath::io
