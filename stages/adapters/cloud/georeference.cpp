// SPDX-License-Identifier: GPL-3.0-or-later
#include "georef/georeference.h"

#include "core/grid_units.h"
#include "stages/adapters/adapters.h"
#include "stages/tile.h"

namespace swath::stages {
namespace {

using core::Column;

georef::Counts place_returns(StripBatch& batch, const Context& context, const trajectory::Trajectory& flown, RunCache& cache,
                             core::Tally& tally) {
  const io::Survey& survey = context.survey;
  const Eigen::Vector3d unit(context.unit, context.unit, context.crs.vertical_metres_per_unit());
  const auto& georeferencer = cache.get([&] {  // by the first batch: it needs the trajectory, which a survey stage has read by then
    return georef::Georeferencer(survey.scanner, survey.calibration, survey.sigma, flown, context.crs, context.origin.cwiseQuotient(unit));
  });
  core::Block block;
  block.origin = georeferencer.origin();
  const georef::Counts counts = georeferencer.run(batch.shots, block);
  if (batch.source < survey.laser.size())
    tally.add_times("outside the trajectory, left out", survey.laser[batch.source].file.filename().string(), counts.outside_times);
  core::scale_columns(unit.x(), unit.z(), block);
  block.origin = context.origin;
  block.strip.assign(block.size(), static_cast<std::uint16_t>(batch.line));
  block.classification.resize(block.size(), core::point_class::never_classified);
  core::keep_in_area(context.area, block, "line " + std::to_string(batch.line), tally);
  batch.block = std::move(block);
  batch.shots = {};
  return counts;
}

}  // namespace

Entry georeference_stage() {
  return strip<place_returns>(
      "georeference", "Takes every return from the scanner's frame to the map, at its own instant, with its uncertainty.",
      {.columns = {.needs = {},
                   .gives = {Column::x, Column::y, Column::z, Column::time, Column::intensity, Column::return_number, Column::return_count,
                             Column::classification, Column::flags, Column::scan_angle, Column::strip, Column::record, Column::range,
                             Column::incidence, Column::sigma_h, Column::sigma_v}},
       .needs = {Product::shots},
       .gives = {Product::points}});
}

}  // namespace swath::stages
