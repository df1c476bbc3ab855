// SPDX-License-Identifier: GPL-3.0-or-later
// What quality.points leaves of every check point: a table and a layer of a map.
#pragma once

#include <string>
#include <vector>

#include "quality/check_marks.h"
#include "stages/adapters/quality/mark_accuracy.h"
#include "stages/stage.h"

namespace swath::stages {

/// NAME.csv and NAME.gpkg.
void write_marks(const Context& context, const std::string& name, const std::vector<quality::CheckMark>& marks,
                 const std::vector<MarkFound>& found, const std::vector<quality::MarkReading>& readings);

}  // namespace swath::stages
