// SPDX-License-Identifier: GPL-3.0-or-later
// Black rims of photographs, as undistorted ones have: what a camera does not show.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "io/raster/image_raster.h"

namespace swath::calib {

/// Pixels whose colours are all 0 and that only such pixels part from the image's edge, along their row or column.
class BlackRim {
 public:
  BlackRim() = default;  ///< hides nothing
  explicit BlackRim(const io::ImageRaster& image);
  /// All hidden until add() shows the rows, a band after another.
  BlackRim(int columns, int rows);
  void add(const io::ImageRaster& band, int first_row);

  /// Keeps what both hide: the rim of a camera is that of all its photographs, dark ground at an edge is not. The same size.
  void intersect(const BlackRim& other);

  /// Compression has mixed the rim with what lies within so many pixels of it.
  void expect_mixed(int pixels) { mixed_ = pixels; }

  bool any() const { return any_; }
  /// Does a place, in pixels from the corner of the first one, lie on the rim, or nearer to it than `margin` pixels?
  bool hides(const Eigen::Vector2d& place, int margin) const;

 private:
  void look_for_any();

  bool any_ = false;
  int mixed_ = 0;
  std::vector<int> left_, right_;  ///< per row: columns [left, right) are shown
  std::vector<int> top_, bottom_;  ///< per column: rows
};

/// The rim that photographs of one camera have in common, by up to five of them. Throws core::Error where one cannot be read.
BlackRim rim_of(const std::vector<std::filesystem::path>& photographs);

}  // namespace swath::calib
