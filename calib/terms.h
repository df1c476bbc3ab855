// SPDX-License-Identifier: GPL-3.0-or-later
// The parameters, returns and geometry of georeferencing are the terms that calibration works in: used here without a prefix.
#pragma once

namespace swath::georef {}

namespace swath::calib {
using namespace georef;
}  // namespace swath::calib
