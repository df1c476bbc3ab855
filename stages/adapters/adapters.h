// SPDX-License-Identifier: GPL-3.0-or-later
// One maker per stage; registry.cpp lists them.
#pragma once

#include <memory>

#include "stages/stage.h"

namespace swath::stages {

std::unique_ptr<Stage> make_rtklib();
std::unique_ptr<Stage> make_trajectory_reader();
std::unique_ptr<Stage> make_imu_reader();
std::unique_ptr<Stage> make_gnss_reader();
std::unique_ptr<Stage> make_ins_gnss();
std::unique_ptr<Stage> make_trajectory_writer();
std::unique_ptr<Stage> make_time_sync();
std::unique_ptr<Stage> make_imu_reader();
std::unique_ptr<Stage> make_gnss_reader();
std::unique_ptr<Stage> make_ins_gnss();
std::unique_ptr<Stage> make_trajectory_writer();
std::unique_ptr<Stage> make_kinematic();
std::unique_ptr<Stage> make_lever_arm();
std::unique_ptr<Stage> make_laser_reader();
std::unique_ptr<Stage> make_las_reader();
std::unique_ptr<Stage> make_adjust();
std::unique_ptr<Stage> make_flat_target();
std::unique_ptr<Stage> make_strips();
std::unique_ptr<Stage> make_geometry();
std::unique_ptr<Stage> make_georeference();
std::unique_ptr<Stage> make_returns();
std::unique_ptr<Stage> make_noise();
std::unique_ptr<Stage> make_outlier();
std::unique_ptr<Stage> make_visibility();
std::unique_ptr<Stage> make_classify();
std::unique_ptr<Stage> make_smrf();
std::unique_ptr<Stage> make_ptd();
std::unique_ptr<Stage> make_robust();
std::unique_ptr<Stage> make_pmf();
std::unique_ptr<Stage> make_csf();
std::unique_ptr<Stage> make_lines();
std::unique_ptr<Stage> make_ground();
std::unique_ptr<Stage> make_water();
std::unique_ptr<Stage> make_hag_dem();
std::unique_ptr<Stage> make_breaklines();
std::unique_ptr<Stage> make_key_points();
std::unique_ptr<Stage> make_dtm();
std::unique_ptr<Stage> make_dsm();
std::unique_ptr<Stage> make_canopy();
std::unique_ptr<Stage> make_relief();
std::unique_ptr<Stage> make_density();
std::unique_ptr<Stage> make_intensity();
std::unique_ptr<Stage> make_contours();
std::unique_ptr<Stage> make_penetration();
std::unique_ptr<Stage> make_las_writer();
std::unique_ptr<Stage> make_gdal_writer();
std::unique_ptr<Stage> make_picture_writer();
std::unique_ptr<Stage> make_truth();

}  // namespace swath::stages
