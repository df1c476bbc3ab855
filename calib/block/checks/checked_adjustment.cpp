// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/checked_adjustment.h"

#include "calib/block/block_start.h"
#include "calib/block/checks/antenna_offsets.h"
#include "calib/block/checks/block_checks.h"
#include "calib/block/checks/block_sample.h"

namespace swath::calib {

CheckedAdjustment adjust_checked(ReadBlock& read, const BlockConfig& config) {
  constexpr size_t points = 2000;  // of the start residual
  refuse_mistakes(read, config);
  const StartResidual start = start_residual(sample_of(read, points).block);
  CheckedAdjustment out{read, {}, {}};
  if (read.started_level) turn_level_images(read.block);
  out.solution = adjust_block(read.block, config.adjust);
  refuse_wrong_stations(out.stated, read, out.solution, config);
  out.found = findings_of(read, config, out.solution);
  for (std::string& sentence : antenna_findings(read.block)) out.found.findings.push_back(std::move(sentence));
  out.found.start_tie = start.tie, out.found.start_control = start.control;
  return out;
}

}  // namespace swath::calib
