// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster/impossible_heights.h"

#include <algorithm>
#include <cmath>

#include "core/config/units.h"
#include "core/geo/crs.h"
#include "core/geo/height_unit.h"
#include "core/printable.h"
#include "io/survey/wild_records.h"

namespace swath::io {
namespace {

constexpr double highest_ground = 9000.0;  // m

}  // namespace

HeightRule::HeightRule(double metre, std::optional<double> nodata) : metre_(metre), declared_(nodata && !std::isnan(*nodata)) {}

bool HeightRule::is_impossible(double value) const {
  if (std::isnan(value)) return false;
  const double height = value * metre_;
  if (!is_a_height(height)) return true;
  if (declared_) return false;
  return is_no_height(value) || (value == 9999.0 && height > highest_ground);
}

void ImpossibleHeights::add(const ImpossibleHeights& more) {
  count += more.count;
  lowest = std::min(lowest, more.lowest);
  highest = std::max(highest, more.highest);
}

double metres_per_height(const std::string& band_unit, const std::string& crs_wkt) {
  if (const auto metres = core::metres_of_unit_name(band_unit)) return *metres;
  return crs_wkt.empty() ? 1.0 : core::Crs(crs_wkt).vertical_metres_per_unit();
}

std::string sentence_of(const ImpossibleHeights& found, const std::filesystem::path& file) {
  const std::string low = core::format_number(found.lowest), high = core::format_number(found.highest), name = file.filename().string();
  const bool one = found.lowest == found.highest, is_ascii = core::lower_case(file.extension().string()) == ".asc";
  return name + ": " + core::counted(found.count, "height") + (one ? " of " + low : " between " + low + " and " + high) +
         ", which no ground has, " + (found.count == 1 ? "is" : "are") + " taken as void; " +
         (!one       ? "declare its value for none (gdal_edit.py -a_nodata)"
          : is_ascii ? "declare the value: NODATA_value " + low + " in its header"
                     : "declare the value: gdal_edit.py -a_nodata " + low + " " + name) +
         ", or the unit of the heights";
}

}  // namespace swath::io
