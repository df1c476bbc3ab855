// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/config/value.h"
#include "io/survey/survey.h"
#include "io/survey/survey_checks.h"

namespace swath::io {

/// Reads and checks a survey.toml (or the same tree as .json), and its calibration_file. Throws Error with all faults.
Survey read_survey(const std::filesystem::path& file);
/// The same from a tree already read (and changed by --set); `folder`: what its file names are relative to.
Survey read_survey(const core::Value& tree, const std::filesystem::path& folder, RecordsIn records = RecordsIn::files);

}  // namespace swath::io
