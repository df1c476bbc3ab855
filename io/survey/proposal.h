// SPDX-License-Identifier: GPL-3.0-or-later
// A survey.toml proposed from the files of a folder.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/survey/find_records.h"

namespace swath::io {

struct Proposal {
  std::string toml;               ///< what is known as keys; what is not as comments that begin with "# ?" and say why
  std::size_t files = 0;          ///< that have a place in it
  std::vector<std::string> open;  ///< what remains to be stated, "gnss[1] time.week: ..."
  std::string config = "survey";  ///< that comes with the program and fits the files
};

/// The survey that the files make, named `name`. `swath check` passes once what is open is filled in.
Proposal propose_survey(const std::vector<FoundFile>& files, const std::string& name);

}  // namespace swath::io
