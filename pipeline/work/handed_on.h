// SPDX-License-Identifier: GPL-3.0-or-later
// What a finished survey stage hands on to the others, as a file of the work folder, so that the stage is not done again.
#pragma once

#include <filesystem>

#include "stages/stage.h"

namespace swath::pipeline {

/// Writes what the context has and had not at `before`, and what it has no more: records, origin and area. IMU records are as large as
/// their file and are read again instead. False, and no file, where it could not be read back the same.
bool write_handed_on(const std::filesystem::path& file, const stages::Records::Marks& before, const stages::Context& context);

/// Gives the context what the file holds. Throws core::SystemError where it is not what was written.
void read_handed_on(const std::filesystem::path& file, stages::Context& context);

}  // namespace swath::pipeline
