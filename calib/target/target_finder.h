// SPDX-License-Identifier: GPL-3.0-or-later
// A calibration target in the data themselves: the largest flat, level, rectangular roof that stands out of its surroundings.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "calib/target/target_edges.h"
#include "calib/terms.h"
#include "georef/shot_geometry.h"
#include "georef/shot_stream.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

struct FinderOptions {
  double stands_out = 3.0;  ///< m above what surrounds it
  double shortest = 10.0;   ///< least length of its sides, m
  double level = 0.05;      ///< steepest tilt, rise / run: the roof's own and that of half a degree of roll error
  double cell = 2.0;        ///< least edge of the height grids' cells, m; wider where a line has fewer than three returns in one
};

/// Roofs in one line's height grid, or the target that most lines agree on.
struct FoundRoof {
  Eigen::Vector2d centre, half;  ///< east, north; half sides, the longer first, m
  double azimuth = 0.0;          ///< of the longer side, from north, rad
  Eigen::Vector3d plane;         ///< up = plane . (1, east, north)
  double share = 0.0;            ///< of the rectangle that its returns fill
  double up(const Eigen::Vector2d& p) const { return plane[0] + plane.tail<2>().dot(p); }
};

/// Searches line by line on grids of heights (memory: returns and cells of one line), then joins what lies at one place within `search` m
/// per m of height. Nothing where no line shows such a roof.
std::optional<RoofTarget> find_roof(const ShotStream& shots, const ShotGeometry& geometry, const trajectory::Trajectory& trajectory,
                                    double search, const FinderOptions& options = {});

/// Heights of one line by cells of a grid.
class HeightGrid {
 public:
  explicit HeightGrid(double cell) : cell_(cell) {}
  void add(const Eigen::Vector3d& local);
  /// The roofs among them, in no particular order.
  std::vector<FoundRoof> roofs(const FinderOptions& options) const;

 private:
  using Key = std::pair<std::int32_t, std::int32_t>;
  bool fit_plane(const std::vector<Key>& patch, const std::vector<Eigen::Vector2d>& centres, const FinderOptions& options,
                 FoundRoof& roof) const;
  bool is_surrounded(const std::vector<Key>& patch, const FinderOptions& options, const FoundRoof& roof) const;

  struct Cell {
    float lowest, highest;
    double sum;
    std::uint32_t n;
    float mean() const { return static_cast<float>(sum / n); }
  };
  double cell_;
  std::unordered_map<std::uint64_t, Cell> cells_;
};

}  // namespace swath::calib
