// SPDX-License-Identifier: GPL-3.0-or-later
// Antennas that are not where they are stated: what the residuals of the stations have in common in the body's axes.
#pragma once

#include <string>
#include <vector>

#include "calib/block/image_block.h"

namespace swath::calib {

/// One sentence for each camera whose antenna is held and whose stations lie elsewhere on average, by five standard deviations of the mean
/// and more than a station's own sigma; with the axes whose sign explains it. `adjusted`: without shift, drift and datum, which take the
/// same up.
std::vector<std::string> antenna_findings(const ImageBlock& adjusted);

}  // namespace swath::calib
