// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/block.h"
#include "io/las/las_block.h"
#include "io/las/las_box.h"
#include "io/las/las_crs.h"
#include "io/las/las_header.h"
#include "io/las/las_points.h"

namespace swath::io {

/// A chunk of a LAZ file.
struct LasChunk {
  std::uint64_t offset = 0, bytes = 0, points = 0;
  std::uint64_t first_record = 0;  ///< number of its first point in the file, from 0
};

/// What of a file is read.
struct LasPart {
  std::optional<std::vector<LasChunk>> chunks{};  ///< of a LAZ file, in its order; unset: all points
  /// Columns that are left out of blocks: what no other one is made of is not decompressed (point formats 6 to 10).
  core::ColumnSet unused{};
};

/// Reads a LAS 1.0 to 1.4 or LAZ file, batch by batch in file order; memory is bounded by the batch (LAZ: and a few chunks).
/// Every fault of the file is a core::Error that names file and byte or point. One object is for one thread at a time.
class LasReader {
 public:
  /// `threads` for LAZ: 1 decompresses in the caller's thread, 0 on one per processor; the result does not depend on it.
  explicit LasReader(std::filesystem::path file, unsigned threads = 0, const LasPart& part = {});
  ~LasReader();
  LasReader(LasReader&&) noexcept;
  LasReader& operator=(LasReader&&) noexcept;

  const LasHeader& header() const;
  /// The CRS that the file states, see las_crs().
  LasCrs crs() const;
  /// What is odd and harmless; complete once the last point is read (points outside the stated bounds are counted while reading).
  const std::vector<std::string>& warnings() const;
  /// The points read so far against the box of the header; what it finds is the last of the warnings.
  const LasBox& box() const;
  /// Points read so far, and those that there are to read.
  std::uint64_t position() const;
  std::uint64_t count() const;

  /// The next points, at most `most`, every field that is decompressed; 0 at the end. Replaces what was in `out`.
  std::size_t read(LasPoints& out, std::size_t most);
  /// The same as map coordinates relative to `out.origin`, which the caller sets; see las_points_to_block(). `number`: of the file from 1,
  /// to keep the records as out.source (io/las/las_source.h); 0: without them.
  std::size_t read(core::Block& out, std::size_t most, const LasTime& time = {}, std::uint32_t number = 0);
  /// What of the times read so far contradicts the file's GPS time bit; empty where nothing does.
  std::string time_fault(core::TimeScale stated) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace swath::io
