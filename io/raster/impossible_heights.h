// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers in a raster of heights that no ground has: values for "none" that its file does not declare.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>

namespace swath::io {

/// What heights of one band are possible.
class HeightRule {
 public:
  /// `metre`: metres per unit of height. `nodata`: the value that the file declares, if any.
  HeightRule(double metre, std::optional<double> nodata);
  /// Beyond every ground and sea floor; or, where the file declares no value for "none", a customary one. 9999 is one where it is higher
  /// than the highest mountain: 9999 ft is a height.
  bool is_impossible(double value) const;

 private:
  double metre_;
  bool declared_;
};

/// Called for every impossible height with the centre of its pixel.
using OnImpossible = std::function<void(double x, double y, double value)>;

/// Counted; plain data.
struct ImpossibleHeights {
  std::uint64_t count = 0;
  double lowest = std::numeric_limits<double>::infinity(), highest = -std::numeric_limits<double>::infinity();  ///< as in the file
  void add(double value) { add({1, value, value}); }
  void add(const ImpossibleHeights& more);
};

/// Metres per unit of a band's heights: its own unit, else that of the CRS, else 1.
double metres_per_height(const std::string& band_unit, const std::string& crs_wkt);

/// "ref.tif: 160 heights of -9999, which no ground has, are taken as void; declare the value: gdal_edit.py -a_nodata -9999 ref.tif".
std::string sentence_of(const ImpossibleHeights& found, const std::filesystem::path& file);

}  // namespace swath::io
