// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace swath::core {

/// What a CRS says of heights: nothing (two axes, or a vertical part on an unknown datum, which states a unit alone), that they are
/// ellipsoidal (three axes, or geocentric), or that they count from a geoid or level (a compound's vertical part).
enum class Heights { unknown, ellipsoidal, vertical };
inline constexpr std::string_view unknown_heights = "height system not stated", ellipsoidal_heights = "ellipsoidal height";

/// The unit of an axis: its length in metres and its name.
struct CrsAxis {
  double factor = 1.0;
  std::string unit = "metre";
};

/// What is kept of a CRS: plain values without any object of PROJ, so that threads may share them.
struct CrsFacts {
  std::string definition, name, wkt, wkt1, horizontal_wkt, vertical_name;
  int epsg = 0, vertical_epsg = 0;
  bool geographic = false, projected = false, geocentric = false, vertical = false;
  Heights heights = Heights::unknown;
  CrsAxis horizontal_axis, vertical_axis;
  bool has_area = false;
  double area[4] = {0, 0, 0, 0};
};

}  // namespace swath::core
