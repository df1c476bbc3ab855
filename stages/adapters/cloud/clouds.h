// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/las/cloud_source.h"
#include "stages/stage.h"

namespace swath::stages {

/// The run's map, for its clouds.
inline io::CloudMap cloud_map(const Context& c) { return {c.crs, c.unit, c.vertical_unit, c.origin, c.area}; }

}  // namespace swath::stages
