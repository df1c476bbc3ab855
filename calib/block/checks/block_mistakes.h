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
/// Kind, order, sign, unit and zero of the angles; none where the table has no angles.
std::vector<Mistake> mistakes_of_angles(const ReadBlock& read, const BlockConfig& config);
/// Stations of the neighbouring image, and their heights in feet; none where no station is observed.
std::vector<Mistake> mistakes_of_stations(const ReadBlock& read);
/// The same within one strip, from one of its images on. `strips`: those that are tried.
std::vector<Mistake> mistakes_within_strips(const ReadBlock& read, const std::vector<int>& strips);

}  // namespace swath::calib
