// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/config/option_visitors.h"
#include "io/survey/survey.h"

namespace swath::io {

/// The same as check_survey() for cameras, lists of images and image points: names that are there twice, conventions, mounts and lever
/// arms that are not stated, files that are not there, tables without the others that they need.
void check_cameras(const Survey& survey, const core::Value& tree, std::vector<core::Fault>& faults);

/// Adds a fault where camera number `camera` of the tree states no principal distance: any default would be a guess.
void expect_distance(const core::Value& tree, size_t camera, std::vector<core::Fault>& faults);

}  // namespace swath::io
