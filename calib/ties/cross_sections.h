// SPDX-License-Identifier: GPL-3.0-or-later
// Vertical cuts through tie planes: what several lines saw of one roof, side by side.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "calib/terms.h"
#include "calib/ties/tie_set.h"
#include "core/block.h"
#include "georef/map_patch.h"

namespace swath::calib {

struct SectionPlan {
  std::string name;                     ///< "roof 14"
  std::array<Eigen::Vector2d, 2> ends;  ///< map, m
  double width = 2.0;                   ///< of the strip whose returns are taken, m
};

/// Up to `most` cuts: through surveyed targets first, then through the steepest roofs that most lines have seen, no two within 60 m of one
/// another; each runs down the slope (a level target: along its longer side) and 10 m beyond the plane on both sides.
/// `unit`: metres per horizontal unit of the patches' CRS.
std::vector<SectionPlan> plan_sections(const TieSet& ties, const MapPatches& map, double unit, size_t most);

/// Returns within the cuts, by line.
class SectionReturns {
 public:
  struct OfLine {
    std::vector<double> along, height;  ///< m from the first end; m
  };

  explicit SectionReturns(std::vector<SectionPlan> plans) : plans_(std::move(plans)), returns_(plans_.size()) {}
  /// Adds a block of one line; coordinates in map metres. Of each cut and line the first `most_of_line` returns are kept.
  void add(int line, const core::Block& block);
  const std::vector<SectionPlan>& plans() const { return plans_; }
  const std::map<int, OfLine>& of(size_t plan) const { return returns_[plan]; }

  static constexpr size_t most_of_line = 2000;

 private:
  std::vector<SectionPlan> plans_;
  std::vector<std::map<int, OfLine>> returns_;
};

}  // namespace swath::calib
