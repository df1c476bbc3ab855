// SPDX-License-Identifier: GPL-3.0-or-later
// What a made block with a mistake is refused with.
#pragma once

#include <string>

#include "calib/block/checks/block_checks.h"
#include "core/error.h"
#include "tests/calib/block/made_files.h"

namespace swath::calib::test {

/// Empty where it is not refused. `adjusts`: what only the adjustment shows, too.
inline std::string refusal(const MadeFiles& m, bool adjusts = false) {
  const TemporaryFolder folder;
  const std::string file = write_made(m, folder.path());
  const BlockConfig config = read_made(file);
  const ReadBlock read = read_block(config, file);
  try {
    refuse_mistakes(read, config);
    if (!adjusts) return {};
    ReadBlock adjusted = read;
    const BlockSolution solution = adjust_block(adjusted.block, config.adjust);
    refuse_wrong_stations(read, adjusted, solution, config);
  } catch (const core::Error& e) {
    return e.text();
  }
  return {};
}

}  // namespace swath::calib::test
