// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/registry.h"

#include "stages/adapters/adapters.h"

namespace swath::stages {

const std::vector<Entry>& registry() {
  static const std::vector<Entry> list = {
      {"gnss.rtklib", make_rtklib},
      {"readers.trajectory", make_trajectory_reader},
      {"readers.imu", make_imu_reader},
      {"readers.gnss", make_gnss_reader},
      {"trajectory.ins_gnss", make_ins_gnss},
      {"time.sync", make_time_sync},
      {"trajectory.kinematic", make_kinematic},
      {"calib.lever_arm", make_lever_arm},
      {"readers.laser", make_laser_reader},
      {"readers.las", make_las_reader},
      {"calib.adjust", make_adjust},
      {"calib.flat_target", make_flat_target},
      {"calib.strips", make_strips},
      {"quality.geometry", make_geometry},
      {"georeference", make_georeference},
      {"filters.returns", make_returns},
      {"filters.noise", make_noise},
      {"filters.outlier", make_outlier},
      {"filters.visibility", make_visibility},
      {"quality.lines", make_lines},
      {"filters.smrf", make_smrf},
      {"filters.ptd", make_ptd},
      {"filters.robust", make_robust},
      {"filters.pmf", make_pmf},
      {"filters.csf", make_csf},
      {"filters.ground", make_ground},
      {"filters.water", make_water},
      {"filters.hag_dem", make_hag_dem},
      {"filters.classify", make_classify},
      {"filters.key_points", make_key_points},
      {"terrain.breaklines", make_breaklines},
      {"terrain.dtm", make_dtm},
      {"terrain.dsm", make_dsm},
      {"terrain.canopy", make_canopy},
      {"terrain.relief", make_relief},
      {"terrain.density", make_density},
      {"terrain.intensity", make_intensity},
      {"terrain.contours", make_contours},
      {"terrain.penetration", make_penetration},
      {"writers.trajectory", make_trajectory_writer},
      {"writers.las", make_las_writer},
      {"writers.gdal", make_gdal_writer},
      {"writers.picture", make_picture_writer},
      {"report.truth", make_truth},
  };
  return list;
}

std::unique_ptr<Stage> make_stage(std::string_view name) {
  for (const Entry& e : registry())
    if (e.name == name) return e.make();
  return nullptr;
}

}  // namespace swath::stages
