// SPDX-License-Identifier: GPL-3.0-or-later
// Which contour interval a terrain model carries: the height classes of topographic maps.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "core/grid.h"

namespace swath::terrain {

/// A class of maps: the standard error of heights (EP) that it allows, as a share of the contour interval; nine heights of ten are then
/// within 1.6449 times as much (PEC).
struct MapClass {
  char name;
  double standard_error;  ///< over the interval
};

/// Brazilian decree 89.817 (1984), article 9: EP 1/3 (A), 2/5 (B), 1/2 (C) of the interval; PEC 1/2, 3/5, 3/4.
inline constexpr std::array<MapClass, 3> map_classes{{{'A', 1.0 / 3.0}, {'B', 2.0 / 5.0}, {'C', 1.0 / 2.0}}};

/// The best class that a model of standard deviation `sigma` keeps with contours every `interval` (one unit); '-' where it keeps none.
char map_class_of(double interval, double sigma);

/// The smallest interval that a model of standard deviation `sigma` carries in a class.
double smallest_interval(const MapClass& c, double sigma);

/// The smallest interval of the usual series 1, 2, 2.5, 5 times a power of ten that is not less than `interval`.
double usual_interval(double interval);

/// Sums over a model's cells, plain data: those of several tiles add up.
struct SurfaceFacts {
  double sum_of_heights = 0.0, sum_of_variances = 0.0;
  std::uint64_t heights = 0, sigmas = 0;
  std::uint64_t beyond = 0;  ///< cells whose own sigma keeps no class of maps at the interval
  double lowest = std::numeric_limits<double>::infinity(), highest = -std::numeric_limits<double>::infinity();
  SurfaceFacts& operator+=(const SurfaceFacts& o);
};
/// Of the cells of `own`, a part of the grid's lattice.
SurfaceFacts facts_of(const core::Grid& grid, const core::Lattice& own, double interval);

/// Contour levels that one map may have: a relief of 4 km every 20 cm. What asks for more has mistaken a unit, and fills the disk.
inline constexpr double max_levels = 20'000;

/// A length in four digits without an exponent: 0.0005, not 5e-04.
std::string written_out(double length);

/// Says, with the heights and the number of levels, that contours every `interval` (m) are more than max_levels; empty where they are not.
/// `unit`: of heights in words, m.
std::string too_many_levels(const SurfaceFacts& facts, double interval, double unit);

/// The least usual interval (m) that max_levels allow; `unit`: as above.
double least_interval(const SurfaceFacts& facts, double unit);

/// The smallest interval of each class, m.
struct ClassIntervals {
  double of[map_classes.size()] = {};
};
template <class V>
void describe(const ClassIntervals& r, V& v) {
  for (size_t k = 0; k < map_classes.size(); ++k)
    v.result({&map_classes[k].name, 1}, r.of[k], core::metres(), "Smallest interval that the model carries in this class.");
}

/// The interval of contours against the model that they are drawn from.
struct CarriedInterval {
  std::optional<double> c_factor{}, model_sigma{}, beyond_class_c{};
  std::optional<std::string> map_class{};
  std::optional<ClassIntervals> smallest{};
  std::vector<std::string> findings{};
};
template <class V>
void describe(const CarriedInterval& r, V& v) {
  v.result("c_factor", r.c_factor, core::plain(0), "Flying height above the mean terrain over the interval; absent without a trajectory.");
  v.result("model_sigma_m", r.model_sigma, core::metres().in_summary(), "Sigma of the model, rms over its cells.");
  v.result("map_class", r.map_class, core::plain().in_summary(), "Class of maps that the interval keeps: A, B, C or none.");
  v.table("smallest_interval_m", r.smallest, "Smallest interval by class of maps.");
  v.result("share_of_cells_below_class_c", r.beyond_class_c, core::share(), "Cells whose own sigma keeps no class at the interval.");
  v.result("findings", r.findings, core::Form{}.only_if(!r.findings.empty()), "What speaks against the contours.");
}

/// `flying_height`: above the ellipsoid or level that heights count from, m; NaN where it is not known. `unit`: metres of the product's
/// unit of heights, for words.
CarriedInterval judge_interval(const SurfaceFacts& facts, double interval, double flying_height, double unit);

}  // namespace swath::terrain
