// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pipeline/warnings.h"

namespace swath::pipeline {

/// The warnings of a report.json: of limits, readers, quality.geometry, quality.points, control that is not used, the work folder.
std::vector<Warning> warnings_in(const core::Value& report);

}  // namespace swath::pipeline
