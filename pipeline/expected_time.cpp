// SPDX-License-Identifier: GPL-3.0-or-later
// Measured 2026-11-27 by bench/scale/costs.py (waves) on one thread, with a build at work on the same machine: 0.9 M returns of a town, 4
// per square metre, 107,401 IMU records. docs/scale.md compares expectations with what was measured.
#include "pipeline/expected_time.h"

#include <algorithm>
#include <array>

namespace swath::pipeline {
namespace {

struct Cost {
  std::string_view stage;
  double microseconds;
};
// What is not listed takes about `usual` for a return, and nothing where it works on the survey as a whole.
constexpr double usual = 0.4, usual_merge = 0.05;
constexpr std::array<Cost, 3> in_surveys{{{"quality.geometry", 0.3}, {"calib.strips", 1.2}, {"calib.adjust", 3.6}}};
constexpr std::array<Cost, 17> in_tiles{{{"filters.ground", 6.5},
                                         {"filters.ptd", 7.0},
                                         {"filters.robust", 7.0},
                                         {"filters.csf", 5.0},
                                         {"filters.classify", 3.7},
                                         {"filters.visibility", 5.1},
                                         {"filters.outlier", 0.9},
                                         {"filters.water", 1.5},
                                         {"terrain.dtm", 3.5},
                                         {"terrain.dsm", 1.1},
                                         {"terrain.contours", 0.9},
                                         {"terrain.penetration", 0.6},
                                         {"quality.density", 0.6},
                                         {"quality.swath", 3.0},
                                         {"quality.lines", 0.6},
                                         {"writers.las", 1.6},
                                         {"writers.gdal", 1.2}}};
constexpr std::array<Cost, 1> in_merges{{{"terrain.contours", 0.8}}};
constexpr std::array<Cost, 2> of_imu_records{{{"trajectory.ins_gnss", 40.0}, {"calib.network", 600.0}}};

template <size_t n>
double of(const std::array<Cost, n>& costs, std::string_view stage, double otherwise) {
  const auto at = std::find_if(costs.begin(), costs.end(), [&](const Cost& c) { return c.stage == stage; });
  return 1e-6 * (at != costs.end() ? at->microseconds : otherwise);
}

}  // namespace

double expected_seconds(std::string_view stage, stages::Grain grain) {
  switch (grain) {
    case stages::Grain::survey:
      return of(in_surveys, stage, 0.0);
    case stages::Grain::strip:
      return 1e-6 * usual;
    case stages::Grain::tile:
      return of(in_tiles, stage, usual);
    case stages::Grain::merge:
      return of(in_merges, stage, usual_merge);
  }
  return 0.0;
}

double expected_seconds_of_imu_record(std::string_view stage) { return of(of_imu_records, stage, 0.0); }

}  // namespace swath::pipeline
