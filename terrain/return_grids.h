// SPDX-License-Identifier: GPL-3.0-or-later
// What the returns of each cell say without any model: how dense they are and how bright.
#pragma once

#include "core/block.h"
#include "core/grid.h"
#include "core/option.h"

namespace swath::terrain {

struct DensityOptions {
  core::Metres cell{1.0};
};

template <class V>
void describe(DensityOptions& o, V& v) {
  v.option("cell", o.cell, core::above(0.0), "Side of one cell.");
}

/// height: usable returns (or, with `pulses`, first returns: those numbered 1 or not numbered) per square metre; 0 where there are none.
/// count: how many. No void cells.
core::Grid density(const core::Block& block, const core::Lattice& window, bool pulses);

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
