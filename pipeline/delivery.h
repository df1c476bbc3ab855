// SPDX-License-Identifier: GPL-3.0-or-later
// Finished products go from the work folder to the output folder, all of them at the end of a run: bad data found late leaves
// the output folder as it was.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

namespace swath::pipeline {

/// Called with each file that a delivery writes or removes; throws where it is to stay.
using Allowed = std::function<void(const std::filesystem::path&)>;

/// Puts every file below the folders `made` to the same place below `output`, each whole and on the disk or not at all, in the order of
/// their names. Products that a tiles.json of an earlier run lists and the new one does not are removed. With `keep` the files of `made`
/// stay apart from the delivered ones (copies); otherwise both are one file where the file system allows. A delivery that was cut short may
/// be repeated. Nothing temporary lies in `output` meanwhile, but where a part of it is another disk. Throws core::SystemError; before
/// anything is touched where a folder has the name of a file, or `allowed` throws.
void deliver(const std::vector<std::filesystem::path>& made, const std::filesystem::path& output, bool keep, const Allowed& allowed = {});

/// Throws core::SystemError where the delivered file is not there with its length.
void expect_delivered(const std::filesystem::path& file, std::uint64_t bytes);

/// Removes a folder under the name `as` beside it, so that one whose removal was cut short is not taken for a whole one. Failures are
/// passed over: what is left is under that name.
void discard(const std::filesystem::path& folder, const std::filesystem::path& as);

}  // namespace swath::pipeline
