// SPDX-License-Identifier: GPL-3.0-or-later
// The equation of one step of a chain of stations and attitudes.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calib/block/image_block.h"

namespace ceres {
class CostFunction;
}

namespace swath::calib {

/// What is observed of one image, and where its unknowns are.
struct ChainMember {
  double* pose = nullptr;
  const double* base = nullptr;                                                         ///< camera_R_local0 by rows
  double *antenna = nullptr, *boresight = nullptr, *drift = nullptr, *datum = nullptr;  ///< the last two: one of them at most
  const double* datum_centre = nullptr;
  bool turned = false;                                             ///< attitudes, too, have the datum
  double u = 0.0;                                                  ///< of the drift
  std::optional<std::array<double, 3>> station{};                  ///< local, m
  std::optional<std::array<double, 9>> observed_local_R_camera{};  ///< with the nominal boresight; by rows
};

/// Residual: root^-1 (e - by_before e_before), each e over the factors of its kind; stations first. `members`: those before, then the
/// image. `blocks` receives the parameters in their order. Ceres takes the result over.
ceres::CostFunction* chain_cost(const NavigationStep& step, const std::vector<ChainMember>& members, const double* station_factor,
                                const double* attitude_factor, std::vector<double*>& blocks);

}  // namespace swath::calib
