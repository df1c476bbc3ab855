// SPDX-License-Identifier: GPL-3.0-or-later
// A hangar survey's results as tables of a page.
#pragma once

#include <string>

#include "calib/hangar/hangar.h"

namespace swath::calib {

/// Stations (Jubanski et al., table 1) and points (table 2) with sigmas in m; lever arms; and each lever arm under roll and pitch of 0 to
/// 10 degrees (eq 3), whose sigma is that of the arm and of a tilt known to `tilt_sigma` (rad).
std::string tables_of(const HangarResult& result, double tilt_sigma);

}  // namespace swath::calib
