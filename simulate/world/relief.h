// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/height_field.h"
#include "simulate/options.h"

namespace swath::simulate {

/// The ground: a terrain model, or analytic, a slope, waves, hills, a scarp, an embankment, a ditch and a lake's basin. Coordinates: metres
/// east and north of the middle of the area in the map frame, heights in the map's height system.
class Relief {
 public:
  struct Sample {
    double height = 0.0;
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();  ///< d height / d (east, north)
    bool water = false;
  };

  /// Where the ditch's middle line runs (normal . p = offset), and how far from it the ground is as good as level again.
  struct Ditch {
    Eigen::Vector2d normal = Eigen::Vector2d::Zero();
    double offset = 0.0, half_width = 0.0;
  };

  Relief() = default;
  /// `half` is the half side of the square that holds everything the beam can reach.
  Relief(const WorldOptions& world, std::int64_t seed, core::Radians direction, double half);
  /// The ground of a terrain model; `middle`: easting and northing of the middle of the area.
  Relief(core::HeightField field, const Eigen::Vector2d& middle);

  /// The ground, or the water's surface where it stands above it.
  Sample at(double e, double n) const;
  double height(double e, double n) const { return at(e, n).height; }
  bool is_water(double e, double n) const { return at(e, n).water; }

  /// Only with an option `ditch` above 0.
  const std::optional<Ditch>& ditch() const { return ditch_; }

  double steepest() const { return steepest_; }  ///< no gradient is longer (analytic bound)
  double highest() const { return highest_; }    ///< analytic bounds within the square
  double lowest() const { return lowest_; }

 private:
  struct Wave {
    Eigen::Vector2d k;
    double amplitude, phase;
  };
  struct Hill {
    Eigen::Vector2d centre;
    double amplitude, inverse_width2;
  };
  /// amplitude * (tanh((d + half) / width) - tanh((d - half) / width)) / 2, or tanh(d / width) / 2 where half is 0.
  struct Step {
    Eigen::Vector2d normal;
    double offset, amplitude, width, half;
  };
  void plan_parts(const WorldOptions& world, const Features& f, std::int64_t seed, core::Radians direction);

  std::optional<core::HeightField> field_;
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
  double base_ = 0.0, steepest_ = 0.0, highest_ = 0.0, lowest_ = 0.0;
  Eigen::Vector2d slope_ = Eigen::Vector2d::Zero();
  std::vector<Wave> waves_;
  std::vector<Hill> hills_;
  std::vector<Step> steps_;
  std::optional<Ditch> ditch_;
  bool lake_ = false;
  Eigen::Vector2d lake_centre_ = Eigen::Vector2d::Zero();
  double lake_radius_ = 0.0, lake_level_ = 0.0;
};

}  // namespace swath::simulate
