// SPDX-License-Identifier: GPL-3.0-or-later
// Points of a LAS file held against the box that its header states.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/report.h"
#include "io/las/las_header.h"
#include "io/las/las_points.h"

namespace swath::io {

/// As reports count points, and what reads them: a flight line of laser records, or a cloud.
constexpr const char* outside_box = "points outside the box of their file's header";
constexpr const char* wrong_box = "flight lines or files with points well outside the box of a header";

class LasBox {
 public:
  static constexpr std::size_t examples_kept = 3;

  /// `points`: of the file, from its row `first`. A step of the header's scale beyond the box is rounding.
  void add(const LasPoints& points, const LasHeader& header, std::uint64_t first);
  /// The point `i` of them alone.
  void add_one(const LasPoints& points, const LasHeader& header, std::uint64_t first, std::size_t i);

  std::uint64_t outside() const { return outside_; }
  /// Does a point lie further outside than bounds that were rounded to fewer digits explain: ten steps of the scale?
  bool is_wrong() const { return wrong_; }
  /// Counts the points outside and, where the box is wrong, one under `wrong_box`; `name`: of the file, for the example.
  void count(const std::string& name, core::Tally& tally) const;
  /// "12 of 4000 points (0.3 %) lie outside the box of the header, by up to 3.2 in x: records 7, 19, 22"; empty where none does. Lengths
  /// are in the file's units.
  std::string fault() const;

 private:
  std::uint64_t points_ = 0, outside_ = 0;
  std::vector<std::uint64_t> examples_;
  Eigen::Vector3d farthest_ = Eigen::Vector3d::Zero();  // beyond the box, along each axis
  bool has_box_ = true, wrong_ = false;
};

}  // namespace swath::io
