// SPDX-License-Identifier: GPL-3.0-or-later
// How large the residuals of each kind of observation are beside what their sigmas predict.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/network/network.h"
#include "calib/network/plane_tests.h"

namespace swath::calib {

struct NetworkComponent {
  std::string kind;   ///< key
  std::string words;  ///< for people
  std::uint64_t observations = 0;
  double redundancy = 0.0;  ///< degrees of freedom that its residuals have
  double factor = 0.0;      ///< sigmas as the residuals show them over those that were used; NaN with less than 3 degrees of freedom
};

/// Of the network's last step, inverted; `apriori`: sigmas of the calibration values' start, infinite for free ones. Kinds that do not
/// occur are left out.
std::vector<NetworkComponent> components_of(const Network& network, const PlaneTests& tests, const std::vector<double>& apriori);

}  // namespace swath::calib
