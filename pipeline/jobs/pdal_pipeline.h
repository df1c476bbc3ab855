// SPDX-License-Identifier: GPL-3.0-or-later
// A pipeline of PDAL (JSON) as a pipeline of ours, for the stages that both have.
#pragma once

#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "core/config/value.h"

namespace swath::pipeline {

/// A list of stages, or a table with "pipeline".
bool is_pdal_pipeline(const core::Value& tree);

/// The config ([run] and [[stage]]); its clouds, as Request::survey_tree; one line for each of PDAL's stages with what differs.
using PdalPipeline = std::tuple<core::Value, core::Value, std::vector<std::string>>;

/// Lengths of a PDAL pipeline are in units of the CRS of its points and become metres. Files are looked for from the working folder, as by
/// PDAL. Throws core::Error (usage) with the place of everything that has no counterpart here: stages, options, branches, points that are
/// deleted in the middle.
PdalPipeline read_pdal_pipeline(const core::Value& tree, const std::filesystem::path& file);

}  // namespace swath::pipeline
