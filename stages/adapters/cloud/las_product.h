// SPDX-License-Identifier: GPL-3.0-or-later
// Points of tiles as LAS files, for the stages that write them.
#pragma once

#include <array>
#include <optional>

#include "io/copc/tile_index.h"
#include "stages/tile.h"

namespace swath::stages {
enum class WrittenTimes { recorded, adjusted };
}

template <>
struct swath::core::Choices<swath::stages::WrittenTimes> {
  static constexpr std::array<std::string_view, 2> names{"recorded", "adjusted"};
};

namespace swath::stages {

struct PointFields {
  std::optional<double> scale;
  std::optional<int> point_format;
  WrittenTimes times = WrittenTimes::recorded;
  bool only_copc = false;  ///< no option: point formats that COPC has, with the CRS as WKT
};

template <class V>
void describe(PointFields& o, V& v) {
  v.option("scale", o.scale, core::above_to(0.0, 1.0),
           "Resolution of coordinates, in units of the CRS; unset: that of the cloud's files, or 0.001.");
  v.option("point_format", o.point_format, core::within(o.only_copc ? 6 : 0, o.only_copc ? 8 : 10),
           "Point format; unset: that of the cloud's files, or 6 (7 with colours).");
  v.option("times", o.times, "Times of clouds: as recorded, or adjusted (adjusted standard GPS time).");
}

/// What stages that write points read: all that there is.
core::ColumnSet all_columns();

/// Writes a tile's points: those of clouds with every field as recorded, others as LAS 1.4 with extra bytes. Tiles differ in the
/// definitions of extra fields alone (io::common_extras). Returns what is known of them.
io::TileFacts write_points(TileJob& job, const Context& context, const PointFields& fields, RunCache& cache,
                           const std::filesystem::path& file);

/// Counts what files that write_points() wrote do not carry on from the cloud's.
void count_not_carried(RunCache& cache, core::Tally& tally);

}  // namespace swath::stages
