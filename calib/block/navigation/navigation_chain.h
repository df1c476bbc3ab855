// SPDX-License-Identifier: GPL-3.0-or-later
// Stations and attitudes whose errors are correlated, as a chain: each image's errors given those of images before it,
//   e_i = B e_before + q,  B = C_ib C_bb^-1,  Cov(q) = C_ii - B C_bi,
// which have the covariance that the pairs state and make independent equations of them.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "calib/block/image_block.h"
#include "calib/block/navigation/orientation_correlation.h"

namespace swath::calib {

/// Which of the six errors are observed.
struct ChainParts {
  int first = 0, size = 6;  ///< 0 and 3: stations alone; 3 and 3: attitudes alone
};

/// `number`: of the images by name; those of `correlation` that it does not have are left out. `turn`: per image of the block, from the
/// axes of the pairs to those of the equations. Throws core::Error: an image of the block without covariance, covariances that are not
/// those of any errors, a pair that is missing between two images that a third one is paired with.
std::vector<NavigationStep> navigation_chain(const OrientationCorrelation& correlation,
                                             const std::unordered_map<std::string, std::uint32_t>& number,
                                             const std::vector<PoseCovariance>& turn, ChainParts parts, const std::string& file);

}  // namespace swath::calib
