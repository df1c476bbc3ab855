// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/records/trajectory_data.h"

namespace swath::core {

/// Calls f(member, name) for every column of a trajectory, in the order of its declaration; the first ten hold double, the sigmas float.
template <class F>
void for_each_trajectory_column(F&& f) {
  using T = TrajectoryData;
  f(&T::time, "time");
  f(&T::latitude, "latitude"), f(&T::longitude, "longitude"), f(&T::height, "height");
  f(&T::roll, "roll"), f(&T::pitch, "pitch"), f(&T::heading, "heading");
  f(&T::v_north, "v_north"), f(&T::v_east, "v_east"), f(&T::v_down, "v_down");
  f(&T::sigma_north, "sigma north"), f(&T::sigma_east, "sigma east"), f(&T::sigma_down, "sigma height");
  f(&T::sigma_roll, "sigma roll"), f(&T::sigma_pitch, "sigma pitch"), f(&T::sigma_heading, "sigma heading");
}

}  // namespace swath::core
