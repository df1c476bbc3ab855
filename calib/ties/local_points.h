// SPDX-License-Identifier: GPL-3.0-or-later
// Raw returns to points of a local frame (east, north, up): what the search for ties between lines works on.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "calib/terms.h"
#include "core/shot.h"
#include "georef/shot_geometry.h"
#include "georef/shot_stream.h"
#include "trajectory/fix_window.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

/// Points in a local frame, m, row by row as the shots; x is NaN where a return has no place (no pose, no range, no beam).
struct PointColumns {
  std::vector<double> x, y, z;
};

/// The equation of georef/shot_geometry.h at the speed of a search (about 15 M returns/s on one core), within 1e-5 m of it. One per thread;
/// the trajectory must outlive it.
class LocalPoints {
 public:
  LocalPoints(const core::Scanner& scanner, const core::Calibration& calibration, const trajectory::Trajectory& trajectory,
              const trajectory::LocalFrame& frame);

  /// Points of all returns; `out` is overwritten.
  void run(const core::Shots& shots, PointColumns& out);

  /// The pose at a recorded time, turned into the local frame; nothing where the trajectory has none.
  struct Place {
    Eigen::Vector3d scanner;       ///< m
    Eigen::Matrix3d local_R_body;  ///< turns body to east, north, up
  };
  std::optional<Place> place_at(double recorded);
  /// Movement of a return's point with boresight roll, pitch and heading: m per rad, local frame, one column each.
  std::optional<Eigen::Matrix3d> by_boresight(double recorded, const Return& r);

  const ShotGeometry& geometry() const { return geometry_; }

 private:
  void enter_interval();

  ShotGeometry geometry_;
  trajectory::LocalFrame frame_;
  trajectory::Cursor cursor_;
  // Of the present interval: polynomial of the place, attitude at its start, nadir in body at its start.
  long number_ = -1;
  Eigen::Vector3d position_[4];
  Eigen::Matrix3d local_R_base_;
  Eigen::Vector3d down_;
};

/// True for the returns that may lie on a surface: the only or last one of their pulse, or of unknown number.
inline bool is_last_return(const core::Shots& s, size_t i) {
  if (s.return_number.empty() || s.return_count.empty()) return true;
  return s.return_count[i] == 0 || s.return_number[i] >= s.return_count[i];
}

/// Reads the stream once. `begin` (may be empty) is called before the first batch with the last returns per m^2 of one line: the first
/// `density_sample` of them over the 5 m cells that they fall into (NaN where the stream has no points). It does not depend on the batches.
constexpr size_t density_sample = 20000;
void stream_points(const ShotStream& stream, LocalPoints& points, const std::function<void(double density)>& begin,
                   const std::function<void(int line, const core::Shots&, const PointColumns&)>& each);

}  // namespace swath::calib
