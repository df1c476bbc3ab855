// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/run_state.h"

#include <algorithm>
#include <cstdio>
#include <thread>

#include "core/error.h"
#include "io/text/output_file.h"

namespace swath::pipeline {

namespace fs = std::filesystem;

RunState::RunState(Plan& p, Progress& shown)
    : plan(p),
      progress(shown),
      output(fs::absolute(p.run.output)),
      work(output / work_name),
      threads(p.run.threads > 0 ? p.run.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))),
      memory(p.run.memory.value),
      grids(p.run.tile.value),
      context{p.survey},
      accounts(p.stages.size()),
      made(p.stages.size()) {}

bool RunState::shares(WaveKind kind, size_t number) const {
  if (!share) return false;
  const Wave wave = waves_of(plan)[share->wave];
  return wave.kind == kind && (kind == WaveKind::strips || wave.stage == number);
}

std::vector<bool> RunState::own_pieces(const std::vector<double>& pieces) const {
  return share ? pieces_of(pieces, share->part, share->parts) : std::vector<bool>(pieces.size(), true);
}

fs::path RunState::folder(size_t number) const {
  char digits[8];
  std::snprintf(digits, sizeof digits, "%02zu-", number);
  return work / (digits + std::string(stage(number).info().name) + "-" + folders[number]);
}

void begin_products(RunState& run, size_t number) {
  std::error_code ec;
  fs::create_directories(run.folder(number), ec);
  if (ec) io::throw_system_error("cannot make the folder", run.folder(number), ec.value());
  run.context.output = run.folder(number) / products_name;
}

void wave_too_early(const RunState& run, const std::string& missing) {
  throw core::usage_error("the wave before is not done: " + missing, run.output.string(),
                          "do all parts of wave " + std::to_string(run.share->wave - 1) + " (" +
                              name_of(run.plan, waves_of(run.plan)[run.share->wave - 1]) + ") first, then this one");
}

void expect_made(const RunState& run, size_t number) {
  for (const PieceFile& f : run.made[number]) {
    std::error_code ec;
    const fs::path file = run.folder(number) / f.name;
    if (fs::file_size(file, ec) != f.bytes || ec) throw damaged_work(file);
  }
}

}  // namespace swath::pipeline
