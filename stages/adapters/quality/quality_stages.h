// SPDX-License-Identifier: GPL-3.0-or-later
// The stages of this folder; registry.cpp lists them.
#pragma once

#include "stages/entry.h"

namespace swath::stages {

Entry pulse_density_stage(), swath_stage(), surface_stage(), quality_report_stage();

}  // namespace swath::stages
