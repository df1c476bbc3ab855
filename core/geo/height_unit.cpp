// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/height_unit.h"

#include <cmath>
#include <cstdio>

#include "core/config/units.h"

namespace swath::core {
namespace {

constexpr std::string_view other_units = "units of ";
constexpr double international_foot = 0.3048, survey_foot = 1200.0 / 3937.0;

std::string digits_of(double metres) { return format_number(metres, 15); }

}  // namespace

bool is_same_unit(double a, double b) { return std::abs(a / b - 1.0) < 1e-9; }  // the two feet are 2e-6 apart

std::string height_unit_name(double metres) {
  if (is_same_unit(metres, 1.0)) return "metre";
  if (is_same_unit(metres, international_foot)) return "foot";
  return is_same_unit(metres, survey_foot) ? "US survey foot" : "height unit";
}

std::string unit_symbol(double metres) {
  if (is_same_unit(metres, 1.0)) return "m";
  if (is_same_unit(metres, international_foot)) return "ft";
  return is_same_unit(metres, survey_foot) ? "ftUS" : std::string(other_units) + digits_of(metres) + " m";
}

std::optional<double> metres_of_unit_name(std::string_view name) {
  if (double metres = 0.0;
      name.starts_with(other_units) && std::sscanf(std::string(name).c_str(), "units of %lf m", &metres) == 1 && metres > 0.0)
    return metres;
  const bool is_metre = name == "metre" || name == "meter";
  const Unit* unit = find_unit(Dimension::length, is_metre ? "m" : name == "foot" ? "ft" : name);
  return unit ? std::optional(unit->factor) : std::nullopt;
}

std::string with_height_unit(const Crs& crs, double metres, std::string_view heights) {
  const std::string name(heights);
  return "COMPD_CS[\"" + crs.name() + " + " + name + "\"," + crs.wkt1() + ",VERT_CS[\"" + name + "\",VERT_DATUM[\"unknown\",2005],UNIT[\"" +
         height_unit_name(metres) + "\"," + digits_of(metres) + "],AXIS[\"Up\",UP]]]";
}

}  // namespace swath::core
