// SPDX-License-Identifier: GPL-3.0-or-later
// The observation equations of a block on Ceres: solved, and linearised for covariance and tests.
//
// Unknowns of an image: its perspective centre, and a rotation vector w about the camera's axes, camera_R_local = exp(w) camera_R_local0.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "calib/block/image_block.h"

namespace swath::calib {

/// Weight of an image point that does not fit: its residual is still there, so that it can come back.
inline constexpr double no_ray_weight = 1e-6;

/// What the observations count, beside their sigmas.
struct BlockWeights {
  double ray = 1.0, station = 1.0, attitude = 1.0, control = 1.0;  ///< factors on the sigmas
  std::vector<double> of_ray;                                      ///< robust weights; empty: 1
};

enum class NodeKind { image, camera, boresight, antenna, drift, datum };

/// Unknowns that are eliminated together.
struct UnknownNode {
  NodeKind kind = NodeKind::image;
  std::uint32_t index = 0;  ///< of image, camera or drift set
  int first = 0;            ///< number of its first unknown
  std::vector<int> components;
};

enum class ObservationKind { ray, station, attitude, control, prior };

struct BlockObservation {
  ObservationKind kind = ObservationKind::ray;
  std::uint32_t index = 0;  ///< of ray, station, attitude, control, or of the prior's unknown
  int component = 0;        ///< coordinate of a control point
  size_t row = 0;           ///< first row
  int rows = 0;
};

/// Rows divided by their sigmas: residual (computed less observed) and derivatives. Columns: the nodes' unknowns, then three per point that
/// takes part.
struct LinearBlock {
  std::vector<UnknownNode> nodes;
  int unknowns = 0;               ///< of the nodes
  std::vector<int> node_of;       ///< per unknown
  std::vector<int> point_column;  ///< per point of the block; -1 where it takes no part
  std::vector<BlockObservation> observations;
  std::vector<size_t> first;  ///< per row, and one more
  std::vector<int> column;
  std::vector<double> value, residual;

  int points() const;
};

struct BlockConvergence {
  bool converged = false;
  int iterations = 0;
  double cost = 0.0;  ///< v' P v
  std::string text;
};

class BlockSystem {
 public:
  /// `block` must outlive it; solve() changes its values. The same block gives the same values to the last bit, anywhere in memory.
  BlockSystem(ImageBlock& block, const BlockWeights& weights);
  ~BlockSystem();
  BlockSystem(const BlockSystem&) = delete;
  BlockSystem& operator=(const BlockSystem&) = delete;

  /// Changes factors and robust weights; an empty list of these leaves them.
  void weigh(const BlockWeights& weights);
  BlockConvergence solve();
  /// At the present values.
  LinearBlock linearise();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Sets block.drifts and drift_of from the stations and drift_sets, and the centre of their datum. Throws core::Error where a set's
/// stations are all at one instant.
void find_drift_sets(ImageBlock& block);

/// Points with enough rays and control coordinates for a position: two rays, or one and all three coordinates.
std::vector<char> determined_points(const ImageBlock& block);

}  // namespace swath::calib
