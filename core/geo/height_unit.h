// SPDX-License-Identifier: GPL-3.0-or-later
// The unit of heights stated beside a CRS that leaves it open.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/geo/crs.h"

namespace swath::core {

/// Two units of length, metres each, that differ by no more than digits of a file.
bool is_same_unit(double a, double b);

/// Name that PROJ and GIS know a unit of `metres` by: "metre", "foot", "US survey foot"; "height unit" for any other.
std::string height_unit_name(double metres);

/// Its symbol, as bands of rasters, axes of charts and tables of values have it: "m", "ft", "ftUS"; "units of 0.201168 m" for any other.
std::string unit_symbol(double metres);

/// Metres of a unit by the names that files have for it: "metre", "meter", "foot", what unit_symbol() writes, and the units of length of
/// core/config/units.h with their other names ("US survey foot", "us-ft", "ftUS" ...); nothing for any other.
std::optional<double> metres_of_unit_name(std::string_view name);

/// Definition of `crs`, which has no vertical part, with one on an unknown datum: it states the unit of heights alone, `metres`, under the
/// name `heights` ("ellipsoidal height"). Without it readers take heights in the unit of the horizontal axes, or in metres.
std::string with_height_unit(const Crs& crs, double metres, std::string_view heights = "height");

}  // namespace swath::core
