// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "core/config/option_visitors.h"
#include "io/survey/survey.h"

namespace swath::io {

/// Where the points or the trajectory of a run are: in files that the survey names, or also in its caller's memory.
enum class RecordsIn { files, memory };

/// Adds a fault for every condition between a survey's options, and with the files on disk, that does not hold: files that are not there,
/// units and time scales not stated, options that would have no effect. `tree`: what the survey was read from, for places. A key that has
/// a fault already gets no second one.
void check_survey(const Survey& survey, const core::Value& tree, std::vector<core::Fault>& faults, RecordsIn records = RecordsIn::files);

/// The key of a table of a list: "image[2]" for the second, `i` = 1.
inline std::string numbered(const char* list, std::size_t i) { return std::string(list) + "[" + std::to_string(i + 1) + "]"; }

/// The place of the deepest table or value on the path "laser[1].time.scale" that the tree has.
core::Location place_in(const core::Value& tree, const std::string& key);

}  // namespace swath::io
