// SPDX-License-Identifier: GPL-3.0-or-later
// The stages of these folders; registry.cpp lists them.
#pragma once

#include "core/tile_columns.h"
#include "stages/entry.h"

namespace swath::stages {

Entry lever_arm_stage(), kinematic_stage(), direct_orientation_stage(), block_adjust_stage(), ins_gnss_stage(), rtklib_stage(),
    time_sync_stage(), latency_stage(), trajectory_reader_stage(), imu_reader_stage(), gnss_reader_stage(), trajectory_writer_stage();
Entry adjust_stage(), flat_target_stage(), strips_stage(), network_stage(), geometry_stage();
Entry laser_reader_stage(), las_reader_stage(), georeference_stage(), returns_stage(), visibility_stage(), lines_stage(), ground_stage(),
    hag_dem_stage(), breaklines_stage(), dtm_stage(), dsm_stage(), canopy_stage(), relief_stage(), density_stage(), intensity_stage(),
    contours_stage(), penetration_stage(), las_writer_stage(), gdal_writer_stage(), picture_writer_stage(), truth_stage(),
    check_points_stage();

/// Refuses the gate of ranges of a filter that reads them where the files of a cloud have none.
void expect_ranges(const Context& context, std::string_view stage, core::TileColumns columns);

}  // namespace swath::stages
