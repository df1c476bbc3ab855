// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/records/gnss_data.h"

namespace swath::core {

/// Calls f(member) for every column, in the order of declaration.
template <class F>
void for_each_gnss_column(F&& f) {
  using T = GnssData;
  f(&T::time), f(&T::position), f(&T::covariance), f(&T::velocity), f(&T::velocity_covariance), f(&T::quality), f(&T::satellites);
}

}  // namespace swath::core
