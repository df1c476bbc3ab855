// SPDX-License-Identifier: GPL-3.0-or-later
// What the steps of a run share. Strips (strips.h), tiles (tiles.h) and the outcome (outcome.h) work on it in the order of the run.
//
// Work folder: OUTPUT/.swath/<nn>-<stage>-<fingerprint>/. A folder's name says what it was made from, so a folder that is
// there is still valid; within it a strip's strip.json or a tile's .done (piece_record.h) says that the piece is whole, which is checked
// before a run goes on from it. Products wait in its products/ until the run is done.
#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "pipeline/engine/account.h"
#include "pipeline/engine/share.h"
#include "pipeline/grid_store.h"
#include "pipeline/memory.h"
#include "pipeline/plan.h"
#include "pipeline/progress.h"
#include "pipeline/provenance.h"
#include "pipeline/stage_memory.h"
#include "pipeline/tile_groups.h"
#include "pipeline/tile_store.h"
#include "pipeline/work/piece_record.h"

namespace swath::pipeline {

struct RunState {
  RunState(Plan& p, Progress& shown);

  Plan& plan;
  Progress& progress;
  std::filesystem::path output, work;
  int threads;
  MemoryBudget memory;
  GridStore grids;
  stages::Context context;
  std::vector<Account> accounts;
  std::vector<std::vector<PieceFile>> made;  ///< by each stage
  std::vector<Input> inputs;
  std::vector<std::string> fingerprints, folders;  ///< of each stage; of the work that its folder holds
  core::ColumnSet kept;                            ///< of the strips' points
  bool keeps_store = false;                        ///< all of their columns, for other runs, too
  size_t source = 0;                               ///< the stage that is the plan's source; as many as there are stages where it has none
  size_t last_strip_stage = 0;
  std::unique_ptr<TileStore> store;
  std::unique_ptr<SquareCounts> squares;
  std::set<TileKey> surface_tiles;       ///< without a point of their own, but a surface reaches into them from their neighbours
  bool has_products = false;             ///< of a tile stage that is finished
  std::optional<Share> share;            ///< what this process does where several do the run together
  std::vector<std::string> over_memory;  ///< survey stages that take more than is free, with the default budget
  std::uint64_t resumed = 0, damaged = 0, read_again = 0;

  const stages::Stage& stage(size_t number) const { return *plan.stages[number].stage; }
  /// Is the wave the one that this process has a share of?
  bool shares(WaveKind kind, size_t number) const;
  /// Which pieces of such work are this process's: all, where it does the run alone.
  std::vector<bool> own_pieces(const std::vector<double>& work) const;
  bool works_on(size_t number, stages::Grain g) const { return plan.works_on(number, g); }
  /// The stage's own folder of work.
  std::filesystem::path folder(size_t number) const;
};

constexpr const char *products_name = "products", *work_name = ".swath";

/// What the stage writes from now on goes to its own folder, from which it is delivered at the end of the run.
void begin_products(RunState& run, size_t number);
/// Throws core::Error (usage): a process has come to work on a wave before the one in front of it is done.
[[noreturn]] void wave_too_early(const RunState& run, const std::string& missing);
/// Whatever the stage has finished is there.
void expect_made(const RunState& run, size_t number);

}  // namespace swath::pipeline
