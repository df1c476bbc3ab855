// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/records/imu_data.h"

namespace swath::core {

/// Calls f(member) for every column, in the order of declaration.
template <class F>
void for_each_imu_column(F&& f) {
  f(&ImuData::time), f(&ImuData::step), f(&ImuData::angle), f(&ImuData::velocity);
}

}  // namespace swath::core
