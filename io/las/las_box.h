// SPDX-License-Identifier: GPL-3.0-or-later
// Points of a LAS file held against the box that its header states.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "io/las/las_header.h"
#include "io/las/las_points.h"

namespace swath::io {

/// As reports count them.
constexpr const char* outside_box = "points outside the box of their file's header";

class LasBox {
 public:
  static constexpr std::size_t examples_kept = 3;

  /// `points`: of the file, from its row `first`. A step of the header's scale beyond the box is rounding.
  void add(const LasPoints& points, const LasHeader& header, std::uint64_t first);

  std::uint64_t outside() const { return outside_; }
  /// "12 of 4000 points (0.3 %) lie outside the box of the header, by up to 3.2 in x: records 7, 19, 22"; empty where none does. Lengths
  /// are in the file's units.
  std::string fault() const;

 private:
  std::uint64_t points_ = 0, outside_ = 0;
  std::vector<std::uint64_t> examples_;
  Eigen::Vector3d farthest_ = Eigen::Vector3d::Zero();  // beyond the box, along each axis
  bool has_box_ = true;
};

}  // namespace swath::io
