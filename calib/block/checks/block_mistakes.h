// SPDX-License-Identifier: GPL-3.0-or-later
// Conventions that files often break, each as the change that would put it right.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/block/block_reading.h"

namespace swath::calib {

struct Mistake {
  std::string what, hint;
  std::function<void(ReadBlock&)> instead;  ///< changes a copy to what it would be without the mistake
};

/// y the other way, mirrored, turned, exchanged.
std::vector<Mistake> mistakes_of_image_axes();
/// Distortion with the sign of corrections; none where it is adjusted, the values being those to start from.
std::vector<Mistake> mistakes_of_cameras(const ReadBlock& read);
/// Kind, order, sign, unit and zero of the angles; none where the table has no angles.
std::vector<Mistake> mistakes_of_angles(const ReadBlock& read, const BlockConfig& config);
/// Stations of the neighbouring image, and their heights in feet; none where no station is observed.
std::vector<Mistake> mistakes_of_stations(const ReadBlock& read);

/// Images of a strip in the order of time.
std::vector<std::uint32_t> flown(const ImageBlock& block, int strip);
/// For each of the images, in that order, the position of the one after (`step` 1) or before (-1); beyond the ends straight on. Two images
/// or more.
std::vector<Eigen::Vector3d> positions_of_next(const ImageBlock& block, const std::vector<std::uint32_t>& images, int step);
/// What to do where stations are those of other images.
extern const char* const match_by_time;

}  // namespace swath::calib
