// SPDX-License-Identifier: GPL-3.0-or-later
#include "georef/georeference.h"

#include <mutex>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "stages/adapters/adapters.h"

namespace swath::stages {
namespace {

class Georeference : public OptionStage<NoOptions, georef::Counts> {
 public:
  const Info& info() const override {
    static const Info info{
        "georeference",
        "Takes every return from the scanner's frame to the map, at its own instant, with its uncertainty.",
        {Grain::strip},
        {},
        {core::Column::x, core::Column::y, core::Column::z, core::Column::time, core::Column::intensity, core::Column::return_number,
         core::Column::return_count, core::Column::classification, core::Column::flags, core::Column::scan_angle, core::Column::strip,
         core::Column::record, core::Column::range, core::Column::incidence, core::Column::sigma_h, core::Column::sigma_v},
        {Product::of<trajectory::Trajectory>(), Product::shots},
        {Product::points}};
    return info;
  }

  void run_strip(const Context& context, StripBatch& batch, core::Tally& tally) const override {
    const std::shared_ptr<const georef::Georeferencer> g = georeferencer(context);
    core::Block block;
    block.origin = g->origin();
    const georef::Counts n = g->run(batch.shots, block);
    core::count_results(n, tally);
    to_metres(context, block);
    block.strip.assign(block.size(), static_cast<std::uint16_t>(batch.line));
    block.classification.resize(block.size(), core::point_class::never_classified);
    core::keep_in_area(context.area, block, "line " + std::to_string(batch.line), tally);
    batch.block = std::move(block);
    batch.shots = {};
  }

 private:
  static Eigen::Vector3d units_of(const Context& context) { return {context.unit, context.unit, context.crs.vertical_metres_per_unit()}; }

  static void to_metres(const Context& context, core::Block& block) {
    const Eigen::Vector3d unit = units_of(context);
    if (unit.x() != 1.0)
      for (auto* column : {&block.x, &block.y})
        for (double& v : *column) v *= unit.x();
    if (unit.z() != 1.0)
      for (double& v : block.z) v *= unit.z();
    block.origin = context.origin;
  }

  /// Made once, by the first batch: it needs the trajectory, which a survey stage has read by then.
  std::shared_ptr<const georef::Georeferencer> georeferencer(const Context& context) const {
    const std::lock_guard lock(mutex_);
    if (!georeferencer_)
      georeferencer_ = std::make_shared<georef::Georeferencer>(context.survey.scanner, context.survey.calibration, context.survey.sigma,
                                                               *record<trajectory::Trajectory>(context), context.crs,
                                                               context.origin.cwiseQuotient(units_of(context)));
    return georeferencer_;
  }
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const georef::Georeferencer> georeferencer_;
};

}  // namespace

std::unique_ptr<Stage> make_georeference() { return std::make_unique<Georeference>(); }

}  // namespace swath::stages
