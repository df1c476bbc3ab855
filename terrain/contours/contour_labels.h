// SPDX-License-Identifier: GPL-3.0-or-later
// Where the heights of index contours are written: on the line, along it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/config/option.h"
#include "terrain/contours/contour_lines.h"

namespace swath::terrain {

/// Which way the letters stand: their top towards higher ground, as on topographic maps, or never upside down with north up.
enum class LabelFacing { uphill, upright };

struct LabelOptions {
  core::Metres spacing{200.0};
  core::Metres height{2.0};
  LabelFacing facing = LabelFacing::upright;
};

template <class V>
void describe(LabelOptions& o, V& v) {
  v.option("spacing", o.spacing, core::above(0.0), "Length of an index contour for each of its labels.");
  v.option("height", o.height, core::above(0.0), "Height of the letters on the ground: 2 mm of the map times its scale.");
  v.option("facing", o.facing, "upright: readable with north up; uphill: the letters' top towards higher ground.");
}

struct ContourLabel {
  Eigen::Vector2d at;  ///< middle of the text, map coordinates
  double angle = 0.0;  ///< of the text's direction, rad, counter-clockwise from east, in (-pi, pi]
};

/// Places labels line by line, none where one stands already. Lines must come in a fixed order for the same labels.
class Labeller {
 public:
  explicit Labeller(const LabelOptions& options) : options_(options) {}
  /// Labels of a text of so many letters on the line: one per `spacing`, on the straightest stretch of each share of the line. A line
  /// shorter than three texts has none, nor has a share that bends by more than 15 % (chord over arc) everywhere.
  std::vector<ContourLabel> add(const ContourLine& line, size_t letters);

 private:
  bool is_free(const Eigen::Vector2d& at, double radius) const;

  LabelOptions options_;
  struct Taken {
    Eigen::Vector2d at;
    double radius;
  };
  std::vector<Taken> taken_;
  double largest_ = 0.0;  ///< radius of all taken
  std::unordered_map<std::uint64_t, std::vector<size_t>> buckets_;
};

}  // namespace swath::terrain

template <>
struct swath::core::Choices<swath::terrain::LabelFacing> {
  static constexpr std::array<std::string_view, 2> names{"uphill", "upright"};
};
