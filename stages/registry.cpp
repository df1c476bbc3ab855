// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/registry.h"

#include "stages/adapters/adapters.h"
#include "stages/adapters/cloud/copc.h"
#include "stages/adapters/cloud/crop.h"
#include "stages/adapters/imagery/photos.h"
#include "stages/adapters/quality/quality_stages.h"
#include "stages/adapters/terrain/buildings.h"
#include "stages/adapters/terrain/forest.h"
#include "stages/adapters/terrain/powerlines.h"
#include "stages/tile_filter.h"

namespace swath::stages {

const std::vector<Entry>& registry() {
  static const std::vector<Entry> list = {
      rtklib_stage(),
      trajectory_reader_stage(),
      imu_reader_stage(),
      gnss_reader_stage(),
      ins_gnss_stage(),
      time_sync_stage(),
      latency_stage(),
      kinematic_stage(),
      direct_orientation_stage(),
      block_adjust_stage(),
      lever_arm_stage(),
      laser_reader_stage(),
      las_reader_stage(),
      adjust_stage(),
      flat_target_stage(),
      strips_stage(),
      network_stage(),
      geometry_stage(),
      georeference_stage(),
      returns_stage(),
      crop_stage(),
      class_filter<filters::flag_noise>(
          "filters.noise", "Isolated points, low points and ranges outside the gate: flagged and classed as noise, never deleted.",
          {.check = expect_ranges}),
      class_filter<filters::flag_outliers>(
          "filters.outlier",
          "Statistical outliers and small groups alone in space (birds, scraps of cloud, multipath): flagged and classed as "
          "noise, never deleted."),
      visibility_stage(),
      lines_stage(),
      ground_filter<filters::classify_ground_smrf>("filters.smrf",
                                                   "Ground points by the Simple Morphological Filter (Pingel, Clarke and McBride 2013)."),
      ground_filter<filters::classify_ground_ptd>("filters.ptd", "Ground points by progressive TIN densification (Axelsson 2000)."),
      ground_filter<filters::classify_ground_robust>(
          "filters.robust", "Ground points by hierarchic robust interpolation (Kraus and Pfeifer 1998; Pfeifer et al. 2001)."),
      ground_filter<filters::classify_ground_pmf>("filters.pmf",
                                                  "Ground points by the progressive morphological filter (Zhang et al. 2003)."),
      ground_filter<filters::classify_ground_csf>("filters.csf", "Ground points by cloth simulation (Zhang et al. 2016)."),
      ground_stage(),
      class_filter<filters::classify_water>(
          "filters.water", "Water (class 9) by level returns where most pulses do not come back; between a ground filter and the terrain."),
      hag_dem_stage(),
      class_filter<filters::classify>("filters.classify",
                                      "Classes of what is not ground: low, medium and high vegetation, buildings, wires, bridge decks."),
      filter<terrain::mark_key_points>(
          "filters.key_points", "Model key points: flags the ground points whose triangulation stays within a tolerance of all of them."),
      breaklines_stage(),
      dtm_stage(),
      dsm_stage(),
      canopy_stage(),
      relief_stage(),
      density_stage(),
      intensity_stage(),
      contours_stage(),
      penetration_stage(),
      forest_stage(),
      buildings_stage(),
      power_lines_stage(),
      orthophoto_stage(),
      true_orthophoto_stage(),
      colour_stage(),
      trajectory_writer_stage(),
      las_writer_stage(),
      copc_writer_stage(),
      gdal_writer_stage(),
      picture_writer_stage(),
      pulse_density_stage(),
      swath_stage(),
      surface_stage(),
      check_points_stage(),
      quality_report_stage(),
      truth_stage(),
  };
  return list;
}

std::vector<std::string> stage_names() {
  std::vector<std::string> names;
  for (const Entry& e : registry()) names.emplace_back(e.name);
  return names;
}

std::unique_ptr<Stage> make_stage(std::string_view name) {
  for (const Entry& e : registry())
    if (e.name == name) return e.make();
  return nullptr;
}

}  // namespace swath::stages
