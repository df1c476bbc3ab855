// SPDX-License-Identifier: GPL-3.0-or-later
// How far the passes of a sample lie apart on smooth ground, and how far their stated errors let them.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calib/geometry/geometry_sample.h"
#include "calib/terms.h"
#include "calib/ties/local_points.h"
#include "core/config/result.h"
#include "core/records/sensor.h"
#include "georef/shot_geometry.h"

namespace swath::calib {

/// A smooth piece of ground as one pass sees it: z = mean.z + slope . (p - mean).
struct GroundCell {
  std::int32_t i = 0, j = 0;
  std::uint32_t n = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();   ///< local, m
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< rise / run, east and north
  double rms = 0.0;                                 ///< of its returns about the plane, m
  std::uint32_t sample = 0;                         ///< one of its returns
};

struct PassGround {
  size_t pass = 0;
  std::uint64_t cells = 0;         ///< with enough returns
  std::vector<GroundCell> smooth;  ///< by i, j
};

/// Side of cells and rms up to which one is smooth, m.
struct GroundOptions {
  double cell = 3.0, smooth = 0.15;
};

std::vector<PassGround> ground_of(const GeometrySample& sample, LocalPoints& points, const GroundOptions& options);

/// The smooth cell that holds a place or lies nearest beside it; null where there is none within a cell's side. The pointer is into
/// `ground`.
const GroundCell* cell_beside(const PassGround& ground, const Eigen::Vector3d& place, double side);

/// Cells that two passes share.
struct SharedCell {
  const GroundCell *a = nullptr, *b = nullptr;
  double apart = 0.0;  ///< a minus b along the normal, m
};
std::vector<SharedCell> shared_cells(const PassGround& a, const PassGround& b, double cell);

/// Takes out level cells of one height that differ by one constant while all others agree within a few sigmas: water, at another level for
/// each pass. That difference, m; nothing where there is no such.
std::optional<double> take_out_water(std::vector<SharedCell>& shared, double sigma);

/// Two lines on the smooth ground that both have seen.
struct LinePair {
  int line_a = 0, line_b = 0;
  size_t pass_a = 0, pass_b = 0;
  std::uint64_t cells = 0;
  double median = 0.0;     ///< a minus b along the normal, m
  double rms = 0.0;        ///< about zero, robust: of the median and the scatter about it, m
  double predicted = 0.0;  ///< what the sigmas make one expect, m
  double outside = 0.0;    ///< share of cells that differ by more than five times that
  double water = 0.0;      ///< difference of the water's level, m; its cells are not among `cells`
};

template <class V>
void describe(const LinePair& r, V& v) {
  v.result("lines", std::array<int, 2>{r.line_a, r.line_b}, "Numbers of the two flight lines.");
  v.result("n", r.cells, "Cells that they share.");
  v.result("median_m", r.median, core::metres().always(), "Median difference along the normal.");
  v.result("rms_m", r.rms, core::metres().always(), "Robust RMS of the differences.");
  v.result("predicted_m", r.predicted, core::metres().always(), "Difference that the stated sigmas predict.");
  v.result("outside", r.outside, core::share().always(), "Share of cells that differ by more than five of those.");
  v.result("water_m", r.water, core::metres(2).only_if(r.water != 0.0), "Difference of level ground that is taken for water, left out.");
}

/// How a cell's place along a direction depends on what a point depends on.
struct CellSensitivity {
  Eigen::Matrix<double, 1, parameter_count> by = Eigen::Matrix<double, 1, parameter_count>::Zero();  ///< m per unit of each
  double own = 0.0;             ///< variance by the scatter of its returns, m2
  trajectory::PoseSigma sigma;  ///< of the trajectory at its return
};
/// `cursor`: of the flight's trajectory. Nothing where that has no pose.
std::optional<CellSensitivity> look_at(const GroundCell& cell, const core::Shots& shots, const Eigen::Vector3d& direction,
                                       const ShotGeometry& geometry, trajectory::Cursor& cursor, const trajectory::LocalFrame& frame);
/// Along this the height of a cell's plane at a fixed place follows a shift of the cell.
Eigen::Vector3d height_direction(const GroundCell& cell);
/// Upwards, of both cells.
Eigen::Vector3d normal_of(const SharedCell& cells);

/// Sigma of the difference of two passes on shared cells, rms over up to 40 of them, m.
double predicted_difference(const std::vector<SharedCell>& shared, const core::Shots& a, const core::Shots& b, const ShotGeometry& geometry,
                            const core::SensorSigma& sensor, const trajectory::Trajectory& trajectory, const trajectory::LocalFrame& frame);

}  // namespace swath::calib
