// SPDX-License-Identifier: GPL-3.0-or-later
// Classes of maps by the accuracy of planimetry and heights, and the C factor of contours.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/option.h"

namespace swath::quality {

enum class MapRule {
  decree,  ///< Brazil, decree 89.817 of 1984
  paper,   ///< Brandalize, tables 06 and 09: heights of class A with the figures of B
  pcd,     ///< Brazil, PEC-PCD of ET-CQDG (2016), heights of points and terrain models
};

/// Times a standard error: 90 % of normal errors are smaller.
constexpr double pec_of_ep = 1.6449;

/// Limits of a class. PEC: 90 % of the errors are smaller; EP: standard error.
struct MapClass {
  std::string name;
  double plan_pec = 0.0, plan_ep = 0.0;      ///< mm on the map
  double height_pec = 0.0, height_ep = 0.0;  ///< of the contour interval
};

/// Best first.
std::vector<MapClass> map_classes(MapRule rule);

/// A class's limits on the ground, m.
struct MapLimits {
  double plan_pec = 0.0, plan_ep = 0.0, height_pec = 0.0, height_ep = 0.0;
};
/// `scale`: the map's number, 1000 for 1:1000; `interval`: between contours, m.
MapLimits ground_limits(const MapClass& c, double scale, double interval);

/// The best class whose limit the standard error `ep` (m) does not exceed, and whose PEC 90 % of the errors (`q90`, m) do not, where it is
/// known. Empty: worse than all.
std::string plan_class(MapRule rule, double scale, double ep, std::optional<double> q90 = {});
std::string height_class(MapRule rule, double interval, double ep, std::optional<double> q90 = {});
/// The worse of two classes; empty where one is.
std::string both_classes(const std::string& plan, const std::string& height);

/// Brandalize (14): contour interval that a flight at height `h` m supports with an instrument of C factor `c`, and the C factor of a
/// survey that gives an interval.
inline double interval_of(double h, double c) { return h / c; }
inline double c_factor_of(double h, double interval) { return h / interval; }

/// The closest contour interval, m, whose class (by name) height_class() gives to a standard error `ep` and, where it is known, to `q90`.
/// Throws core::Error: no such class.
double closest_interval(MapRule rule, const std::string& name, double ep, std::optional<double> q90 = {});

}  // namespace swath::quality

namespace swath::core {
template <>
struct Choices<quality::MapRule> {
  static constexpr std::array<std::string_view, 3> names{"decree", "paper", "pcd"};
};
}  // namespace swath::core
