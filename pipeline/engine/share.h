// SPDX-License-Identifier: GPL-3.0-or-later
// A run that several processes do together, on one machine or many, over one work folder. Its waves follow one another; within a wave the
// processes share the pieces, and none needs another's. The last wave is a run of its own: it finds every piece done, checks and delivers.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/plan.h"

namespace swath::pipeline {

enum class WaveKind { survey, strips, tiles, finish };

struct Wave {
  WaveKind kind = WaveKind::survey;
  size_t stage = 0;  ///< number in the plan, of `tiles`
  /// Can its pieces be shared?
  bool is_shared() const { return kind == WaveKind::strips || kind == WaveKind::tiles; }
};

/// The waves of a plan in their order: survey, strips, the tiles of each tile stage, and the end with the merges.
std::vector<Wave> waves_of(const Plan& plan);

/// "survey", "strips", "filters.ground", "finish".
std::string name_of(const Plan& plan, const Wave& wave);

/// What one process does: of wave `wave`, the part `part` of `parts`.
struct Share {
  size_t wave = 0;
  int part = 1, parts = 1;    ///< part from 1 to parts
  std::string fingerprint{};  ///< of the plan that it is a share of; empty: not compared
};

constexpr int max_parts = 100000;  ///< of a wave

/// "i/n" with 1 <= i <= n <= max_parts. Throws core::Error (usage).
Share read_share(size_t wave, const std::string& part);

/// Which pieces of such work are the part's: the largest first to whoever has least, so that every process comes to the same answer alone.
std::vector<bool> pieces_of(const std::vector<double>& work, int part, int parts);

/// While it lives no other process does the same piece; one that asks waits. A process that is killed gives it up. The pieces of a folder
/// share one file, each with a byte of its own that is locked: file systems of clusters hold few files well.
class PieceLock {
 public:
  explicit PieceLock(const std::filesystem::path& piece);
  ~PieceLock();
  PieceLock(const PieceLock&) = delete;
  PieceLock& operator=(const PieceLock&) = delete;

 private:
  int fd_;
};

}  // namespace swath::pipeline
