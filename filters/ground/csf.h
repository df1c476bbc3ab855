// SPDX-License-Identifier: GPL-3.0-or-later
// Ground points by cloth simulation: Zhang, Qi, Wan, Wang, Xie, Wang & Yan 2016, Remote Sensing 8(6), 501.
#pragma once

#include "core/block.h"
#include "core/config/option.h"
#include "filters/ground/ground_labels.h"

namespace swath::filters {

struct CsfOptions {
  core::Metres resolution{1.0};
  int rigidness = 3;
  double step = 0.65;
  int iterations = 500;
  core::Metres threshold{0.5};
  bool smooth = true;
  core::Metres span{50.0};
};

template <class V>
void describe(CsfOptions& o, V& v) {
  v.option("resolution", o.resolution, core::above(0.0), "Distance between the cloth's particles.", "Zhang2016, GR");
  v.option("rigidness", o.rigidness, core::within(1, 10),
           "Inner forces per step: 1 steep terrain, 2 relief with few buildings, 3 flat or built-up terrain.", "Zhang2016, RI");
  v.option("step", o.step, core::within(0.2, 2.0), "Time step: gravity moves the free cloth by 0.2 step^2 metres more in each step.",
           "Zhang2016, dT");
  v.option("iterations", o.iterations, core::within(1, 10000), "Most steps; the cloth may come to rest earlier.", "Zhang2016");
  v.option("threshold", o.threshold, core::above(0.0), "Largest distance of a ground point from the cloth.", "Zhang2016, h_cc");
  v.option("smooth", o.smooth, "Lay the cloth down on slopes beside what it lies on: the post-processing for steep slopes.",
           "Zhang2016, ST");
  v.option("span", o.span, core::above(0.0), "Width of the widest building or void: the cloth is cut into squares of twice this side.");
  v.check(o.span >= o.resolution, "span must hold at least one particle");
}

/// The columns that it works with.
inline core::TileColumns columns(const CsfOptions&) { return ground_columns; }

/// Metres of points around a tile that its result depends on.
double halo(const CsfOptions& o);

/// Sets class ground or unassigned on the usable points among the first `own`; those after are the halo and keep their class.
/// Only last and only returns can be ground.
GroundCounts classify_ground_csf(core::Block& block, size_t own, const CsfOptions& o);

}  // namespace swath::filters
