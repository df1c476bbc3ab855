// SPDX-License-Identifier: GPL-3.0-or-later
// Calibration files: values, sigmas and correlations as the adjustment writes them.
#pragma once

#include <filesystem>

#include "core/config/value.h"
#include "core/records/sensor.h"

namespace swath::io {

/// Replaces the values that a calibration file states. The file is a table with the tables `calibration` (keys as [calibration]) and
/// `sigma` (as [sigma]) and the correlations of their errors (`correlation`), further keys passed over; or the keys of [calibration]
/// themselves beside `sigma`. Throws Error with all faults.
void load_calibration(const std::filesystem::path& file, core::Calibration& calibration, core::SensorSigma& sigma);
/// The tree that load_calibration() reads back.
core::Value calibration_tree(const core::Calibration& calibration, const core::SensorSigma& sigma);

/// Keeps in `sigma.stated` which sigmas a table states.
void note_stated(const core::Value& table, core::SensorSigma& sigma);

}  // namespace swath::io
