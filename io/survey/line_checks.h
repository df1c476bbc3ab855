// SPDX-License-Identifier: GPL-3.0-or-later
// The flight lines of a survey among one another.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/survey/survey.h"

namespace swath::io {

struct LineFault {
  std::size_t line = 0;   ///< from 0
  std::string key, what;  ///< of the line's table
  std::string hint{};
};

/// Ids that stand twice, lines that do not end after they start or that overlap in time.
std::vector<LineFault> line_faults(const Survey& survey);

}  // namespace swath::io
