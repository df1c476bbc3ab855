// SPDX-License-Identifier: GPL-3.0-or-later
// A river given as an area: its banks, how they face one another, and a surface that falls along them.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "terrain/tin/tin.h"

namespace swath::terrain {

/// The outline with a vertex at least every `step` (m); first vertex not repeated; heights linear.
std::vector<Eigen::Vector3d> sampled_ring(const std::vector<Eigen::Vector3d>& ring, double step);

/// Two banks between the ends of a river. Rungs lead from one end to the other; both banks advance along them and never turn back.
struct Banks {
  std::vector<size_t> left, right;               ///< vertices of the outline; both begin at one end and finish at the other
  std::vector<std::pair<size_t, size_t>> rungs;  ///< index in left, index in right; neighbours differ by at most one on each side
};

/// The ends are where the outline parts into two halves that run closest to one another; the rungs are the monotone pairing of least sum
/// of squared widths (dynamic time warping, Sakoe & Chiba 1978).
Banks banks_of(const std::vector<Eigen::Vector3d>& ring);

/// The non-increasing (or, with `falls` false, non-decreasing) sequence of least weighted squares, by pooling adjacent violators (Ayer et
/// al. 1955). Entries of weight 0 take the value between their neighbours. `sum`: receives the weighted sum of squares where not null.
std::vector<double> monotone(const std::vector<double>& values, const std::vector<double>& weights, bool falls, double* sum = nullptr);

/// Heights of an outline's vertices that fall along both banks, nearest to those given, each bank by itself.
void make_banks_fall(std::vector<Eigen::Vector3d>& ring, const Banks& banks);

/// The same from values at the rungs: level from bank to bank. Values of weight 0 are not known.
void level_across(std::vector<Eigen::Vector3d>& ring, const Banks& banks, const std::vector<double>& values,
                  const std::vector<double>& weights);

/// The surface spanned between the banks along the rungs.
Tin river_surface(const std::vector<Eigen::Vector3d>& ring, const Banks& banks);

}  // namespace swath::terrain
