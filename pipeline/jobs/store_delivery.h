// SPDX-License-Identifier: GPL-3.0-or-later
// Finished products copied whole from the output folder to an object store.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "pipeline/run.h"

namespace swath::pipeline {

/// What was copied.
struct Copied {
  std::uint64_t files = 0, bytes = 0;
  bool is_earlier = false;  ///< products of an earlier call, whose copies were not all made
};

/// Throws core::usage_error where the name is not a place in a store that can be written.
void check_store(const std::filesystem::path& store);

/// Runs the plan, then copies every file of the output folder to its place below the address `store`, the report last; the size of each
/// object is held against the file's. Where an earlier call made the products of this plan and they are still whole, they are copied alone.
/// Throws core::Error as run(), and core::SystemError that names the object that could not be written: the products stay in the output.
Outcome run_to_store(Plan& plan, Progress& progress, const std::string& command, const std::filesystem::path& store, Copied& copied);

}  // namespace swath::pipeline
