// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/on_progress.h"
#include "io/copc/record_buckets.h"
#include "io/las/las_header.h"

namespace swath::io {

struct CopcWriteOptions {
  std::filesystem::path folder;  ///< of temporary files: as large as the records
  double memory = 1e9;           ///< bytes; a cloud of any size is written within about as many
  unsigned threads = 0;          ///< that compress: 1 the caller's, 0 one per processor
};

/// What a file holds.
struct CopcWritten {
  std::uint64_t points = 0, nodes = 0;
  int levels = 0;
  double spacing = 0.0;  ///< between points of the root, units of the coordinates
};

/// Writes a COPC 1.0 file: LAS 1.4, point format 6, 7 or 8, one compressed chunk per node. `header` is taken as it is but for counts,
/// bounds, lengths and the records of LAZ and COPC; `records` are laid out as it says. Within a node points are in order of time. The bytes
/// depend on header and points alone: not on their order, on memory or threads. The file appears whole or not at all. Throws core::Error
/// for another point format, and where more points lie within the smallest cube than one chunk can hold.
CopcWritten write_copc(const std::filesystem::path& file, LasHeader header, const RecordStream& records, const CopcWriteOptions& options,
                       const core::OnProgress& progress = core::unwatched);

}  // namespace swath::io
