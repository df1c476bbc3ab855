// SPDX-License-Identifier: GPL-3.0-or-later
// What the returns of each cell say without any model: how dense they are and how bright.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/block.h"
#include "core/config/option.h"
#include "core/grid.h"

namespace swath::terrain {

struct DensityOptions {
  core::Metres cell{1.0};
  core::Metres max_gap{60.0};
};

template <class V>
void describe(DensityOptions& o, V& v) {
  v.option("cell", o.cell, core::above(0.0), "Side of one cell.");
  v.option("max_gap", o.max_gap, core::at_least(0.0),
           "An empty cell has density 0 where returns lie on all sides within this; otherwise it is void.");
}

/// Width of the border of points around a window that density() needs, m.
double halo(const DensityOptions& options);

/// height: usable returns (or, with `pulses`, first returns: those numbered 1 or not numbered) per square metre, over the whole cell, on
/// the cells of `window` (window.cell must be options.cell, else Error). count: how many. reason: none or no_data, by the rule of
/// terrain/voids.h for all usable returns.
core::Grid density(const core::Block& block, const core::Lattice& window, const DensityOptions& options, bool pulses);

/// Sets the column incidence of the points over a known cell of `terrain` to the angle, rad, between their beam and the normal of the
/// terrain there (Horn's gradients of 3 x 3 cells). `scanner`: its position at each point's time, relative to the block's origin, m. Other
/// points, and those whose scanner is not finite, keep theirs; where there was no such column it is made, with 0.
void set_incidence(core::Block& block, const core::Grid& terrain, const std::vector<Eigen::Vector3d>& scanner);

struct IntensityOptions {
  core::Metres cell{1.0};
  core::Metres reference{1000.0};
  core::Radians steepest = core::degrees(70.0);
};

template <class V>
void describe(IntensityOptions& o, V& v) {
  v.option("cell", o.cell, core::above(0.0), "Side of one cell.");
  v.option("reference", o.reference, core::above(0.0), "Range to which intensities are brought, by the square of the range.", "Hofle2007");
  v.option("steepest", o.steepest, core::within(0.0, 1.55),
           "Angles of incidence above this count as this; 0: no correction for incidence.");
}

/// height: mean intensity of the usable single returns of the cell (of several returns of a pulse each has a part of its energy), each
/// times (range / reference)^2 / cos(incidence) where the Block has these columns and the point a range above 0. count: their number.
/// reason: none or no_data.
core::Grid intensity(const core::Block& block, const core::Lattice& window, const IntensityOptions& options);

/// Surface less terrain on one lattice (otherwise Error), at least 0. sigma: of both, taken as independent, where both have it. reason: the
/// terrain's, else the surface's.
core::Grid canopy(const core::Grid& surface, const core::Grid& terrain);

}  // namespace swath::terrain
