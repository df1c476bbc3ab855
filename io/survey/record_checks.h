// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/config/value.h"
#include "io/survey/survey.h"

namespace swath::io {

/// Holds the files of a survey against what it says of them, by their headers and first records: columns that it names and the file does
/// not have, scan angles that cannot be in the unit stated. Throws core::Error (usage) with all faults. `tree`: what the survey was read
/// from, for places.
void check_records(const Survey& survey, const core::Value& tree);

}  // namespace swath::io
