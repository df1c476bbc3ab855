// SPDX-License-Identifier: GPL-3.0-or-later
// One maker per stage; registry.cpp lists them.
#pragma once

#include <memory>

#include "core/tile_columns.h"
#include "stages/stage.h"

namespace swath::stages {

std::unique_ptr<Stage> make_laser_reader();
std::unique_ptr<Stage> make_las_reader();
std::unique_ptr<Stage> make_georeference();
std::unique_ptr<Stage> make_returns();
std::unique_ptr<Stage> make_visibility();
std::unique_ptr<Stage> make_lines();
std::unique_ptr<Stage> make_ground();
std::unique_ptr<Stage> make_hag_dem();
std::unique_ptr<Stage> make_breaklines();
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

/// Refuses the gate of ranges of a filter that reads them where the files of a cloud have none.
void expect_ranges(const Context& context, std::string_view stage, core::TileColumns columns);

}  // namespace swath::stages
