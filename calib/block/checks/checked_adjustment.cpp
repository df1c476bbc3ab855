// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/checked_adjustment.h"

#include "calib/block/block_start.h"
#include "calib/block/checks/antenna_offsets.h"
#include "calib/block/checks/block_checks.h"
#include "calib/block/checks/block_sample.h"
#include "calib/block/checks/held_values.h"
#include "calib/block/checks/mount_directions.h"
#include "calib/block/checks/shifted_strip.h"
#include "calib/block/checks/stated_values.h"
#include "calib/block/checks/wrong_attitudes.h"
#include "core/error.h"

namespace swath::calib {
namespace {

/// A strip whose images started level at the stations of others turns away from its neighbours, and the block falls apart: what is not
/// determined then is not what is wrong.
BlockSolution adjusted(ReadBlock& read, const ReadBlock& stated, const BlockConfig& config) {
  constexpr double times = 1.3;
  if (!read.started_level) return adjust_block(read.block, config.adjust);
  turn_level_images(read.block);
  try {
    return adjust_block(read.block, config.adjust);
  } catch (const core::Error&) {
    refuse_shifted_strip(stated, config, times);
    throw;
  }
}

}  // namespace

CheckedAdjustment adjust_checked(ReadBlock& read, const BlockConfig& config) {
  constexpr size_t points = 2000;  // of the start residual
  refuse_mistakes(read, config);
  const StartResidual start = start_residual(sample_of(read, points).block);
  CheckedAdjustment out{read, {}, {}};
  out.solution = adjusted(read, out.stated, config);
  refuse_wrong_stations(out.stated, read, out.solution, config);
  refuse_wrong_attitudes(out.stated, read, config);
  out.found = findings_of(read, config, out.solution);
  std::vector<std::string> notes = held_value_findings(read.block, out.solution.weights);
  if (notes.empty()) notes = antenna_findings(read.block);  // a principal point with the other sign moves images from their antennas
  for (std::string& sentence : stated_value_findings(out.stated, config, out.found)) notes.push_back(std::move(sentence));
  for (std::string& sentence : mount_findings(read, config)) notes.push_back(std::move(sentence));
  for (std::string& sentence : notes) out.found.findings.push_back(std::move(sentence));
  out.found.start_tie = start.tie, out.found.start_control = start.control;
  return out;
}

}  // namespace swath::calib
