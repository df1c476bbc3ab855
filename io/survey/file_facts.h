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
#include "core/records/number_count.h"

namespace swath::io {

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
