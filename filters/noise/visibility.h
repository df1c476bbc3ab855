// SPDX-License-Identifier: GPL-3.0-or-later
// What the beams passed and what they met: noise in space that other beams found empty, penetration, gap fraction, ground never seen.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/block.h"
#include "core/config/option.h"
#include "core/grid.h"

namespace swath::filters {

struct VisibilityOptions {
  core::Metres voxel{2.0};
  core::Metres reach{40.0};
  double solid = 0.02;
  int group = 1;
  core::Metres cell{10.0};
};

template <class V>
void describe(VisibilityOptions& o, V& v) {
  v.option("voxel", o.voxel, core::above(0.0), "Side of one voxel.", "Hornung2013");
  v.option("reach", o.reach, core::above(0.0), "Length of each beam, counted upwards from its return, that is followed.");
  v.option("solid", o.solid, core::within(0.0, 1.0),
           "Share of the beams through a return's 27 voxels that must end there, else it is noise; 0 keeps all.");
  v.option("group", o.group, core::within(1, 1000), "Most returns in these 27 voxels that can be noise together; wires have more.");
  v.option("cell", o.cell, core::above(0.0), "Side of one cell of the rasters.");
  v.check(o.reach >= o.voxel, "reach must span at least one voxel");
  v.check(o.cell >= o.voxel, "cell must span at least one voxel");
}

/// Rasters on a lattice, row-major as in core::Grid.
struct Visibility {
  core::Lattice lattice;
  int layers = 0;                                    ///< of one voxel's height each, upwards from the cell's lowest ground return
  std::vector<std::uint32_t> pulses, ground_pulses;  ///< by last return
  std::vector<std::uint8_t> entered;                 ///< 1 where any beam passed or ended in the cell's column
  std::vector<std::uint64_t> passed, met;            ///< [cell * layers + layer]: voxels passed; returns not of class ground

  /// Share of the cell's pulses that reached the ground; NaN where there is no pulse.
  double penetration(size_t cell) const;
  /// Share of the beams that entered the layer's voxels and passed; NaN where none entered or the cell has no ground return.
  double gap(size_t cell, int layer) const;
  /// Share that passes all layers but the lowest: the product of their gaps, those that no beam entered left out; NaN as above.
  double gap_fraction(size_t cell) const;
  /// Where the ground was seen: height is the penetration. Void reason never_seen where beams came and none reached the ground, no_data
  /// where no beam came at all.
  core::Grid seen() const;
};

struct VisibilityCounts {
  std::uint64_t noise = 0;        ///< flagged, class 18
  std::uint64_t untouched = 0;    ///< withheld or already noise
  std::uint64_t no_position = 0;  ///< own returns whose scanner position is not known: met, but their beams are not followed
};

/// Metres of points around a tile that its result depends on.
double halo(const VisibilityOptions& o);

/// Sets flag isolated and class 18 on those of the first `own` points that lie where other beams passed; those after are the halo and stay
/// as they are. `scanner`: the scanner's position at each point's time, relative to the block's origin, m; NaN where unknown. Fills the
/// rasters on `lattice` (of cell o.cell; within o.cell of the own points' tile). A return below the ground is passed by no beam and is
/// left to other filters. Throws core::Error where tile / voxel is more than 60 000.
/// Needs column time (pulses are the points of one time and strip). The result depends on the points within halo() and not on their order.
VisibilityCounts trace_visibility(core::Block& block, size_t own, const std::vector<Eigen::Vector3d>& scanner, const core::Lattice& lattice,
                                  const VisibilityOptions& o, Visibility& out);

/// What a call needs beside the block, bytes: for every point, and for every column of voxels that beams pass or may pass.
constexpr double visibility_bytes_per_point = 64.0;
double visibility_bytes_per_column(const VisibilityOptions& o);
/// Most voxel columns whose voxels one point's beam makes, in columns as tall as `reach`.
double visibility_columns_per_point();

}  // namespace swath::filters
