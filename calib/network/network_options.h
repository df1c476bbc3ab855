// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the joint adjustment of IMU, GNSS and laser surfaces.
#pragma once

#include "calib/adjust/adjust_options.h"
#include "calib/ties/tie_plane_options.h"
#include "core/config/option.h"
#include "trajectory/ins/ins_options.h"

namespace swath::calib {

/// Test of displacements of single groups: one line's returns on one plane.
struct GroupTestOptions : SnoopingOptions {};

template <class V>
void describe(GroupTestOptions& o, V& v) {
  describe_snooping(o, v, "Test each plane in each line for a displacement, and leave it out.",
                    "Maximum share of the groups that the test may leave out.");
}

struct NetworkOptions {
  NetworkOptions() {
    planes.mismatch.value = 0.5;
    planes.planes = 20000;
    estimate = {false, false, false, false, false, false, false, false, false, false, false};
  }
  trajectory::InsGnssOptions smoother;
  TiePlaneOptions planes;
  EstimateOptions estimate;
  AprioriOptions apriori;  ///< not an option: start_sigmas()
  RobustOptions robust;
  GroupTestOptions snooping;
  bool estimate_surface = true;
  core::Metres surface_sigma{0.003};
  int rounds = 4, iterations = 12;
};

template <class V>
void describe(NetworkOptions& o, V& v) {
  v.table("smoother", o.smoother, "The smoother of IMU and GNSS that the adjustment begins from, and whose error model it has.");
  v.table("planes", o.planes, "The search for planes; `mismatch` is that of the first round.");
  v.table("estimate", o.estimate, "Calibration values that are unknowns, about the survey's with its sigmas; the others are held.");
  v.table("robust", o.robust, "Weights of single returns, and of one line's returns on one plane.");
  v.table("snooping", o.snooping, "Search for planes that are displaced in one line.");
  v.option("surface_sigma", o.surface_sigma, core::at_least(0), "Sigma by which a plane seen in one line departs from that of all lines.");
  v.option("estimate_surface", o.estimate_surface, "Estimate that sigma from the residuals; the stated one is its start.");
  v.option("rounds", o.rounds, core::within(1, 20), "Maximum number of searches for planes; they end where the returns stay in place.");
  v.option("iterations", o.iterations, core::within(2, 100),
           "Maximum number of linearisations of a solution; a round has several solutions.");
}

}  // namespace swath::calib
