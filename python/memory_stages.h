// SPDX-License-Identifier: GPL-3.0-or-later
// Stages at the ends of a plan whose points, trajectory and results are in the caller's memory.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/block.h"
#include "core/grid.h"
#include "core/records/trajectory_data.h"
#include "io/vector/vector.h"
#include "stages/entry.h"
#include "trajectory/trajectory.h"

namespace swath::python {

/// Points in columns of the caller's, which outlive the run. Elements are of the types that core::Block has; places in units of the CRS.
struct BorrowedPoints {
  size_t size = 0;
  std::array<const void*, core::column_count> columns{};  ///< null: not there; x, y, z are
  bool weekless = false;                                  ///< times are seconds of a week that nothing names

  template <class T>
  const T* column(core::Column c) const {
    return static_cast<const T*>(columns.at(static_cast<size_t>(c)));
  }
};

/// What a run leaves in memory.
struct Taken {
  core::ColumnSet columns{};                   ///< asked for, into `to`
  std::array<void*, core::column_count> to{};  ///< of the caller's: one element per record of the source; x, y, z in units of the CRS
  std::uint8_t* reached = nullptr;             ///< becomes 1 at the records that came to the end
  std::vector<stages::Product> products{};     ///< grids asked for
  std::vector<core::Grid> grids{};             ///< of each, in units of the CRS, without the empty rim
  std::string lines_file{};                    ///< asked for: contours, by the name of their file within the output; empty: none
  io::VectorLines lines{};
  core::TrajectoryData trajectory{};
};

/// "python.points": the source of a plan on such points.
stages::Entry points_stage(const BorrowedPoints& points);
/// "python.trajectory": gives a trajectory that was computed before.
stages::Entry trajectory_stage(const core::TrajectoryData& data, trajectory::TrajectoryOptions options);
/// "python.take": the last stage of a plan on points.
stages::Entry take_stage(Taken& taken);
/// "python.take_trajectory": the last stage of a plan of survey stages.
stages::Entry take_trajectory_stage(Taken& taken);

}  // namespace swath::python
