// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/calibration_views.h"

#include "georef/georeference.h"
#include "stages/adapters/units.h"
#include "stages/shot_source.h"

namespace swath::stages {
namespace {

/// One geometry at work: returns to blocks in map metres.
class Mapper {
 public:
  Mapper(const Context& context, const Geometry& g)
      : context_(context),
        georeferencer_(context.survey.scanner, *g.calibration, context.survey.sigma, *g.trajectory, context.crs,
                       Eigen::Vector3d(context.origin.x() / context.unit, context.origin.y() / context.unit,
                                       context.origin.z() / context.crs.vertical_metres_per_unit()),
                       false) {}
  core::Block operator()(const core::Shots& shots) const {
    core::Block block;
    block.origin = georeferencer_.origin();
    georeferencer_.run(shots, block);
    const double h = context_.unit, v = context_.crs.vertical_metres_per_unit();
    for (size_t i = 0; i < block.size(); ++i) block.x[i] *= h, block.y[i] *= h, block.z[i] *= v;
    block.origin = context_.origin;
    return block;
  }
  const georef::MapPatches& map() const { return georeferencer_.map(); }

 private:
  const Context& context_;
  georef::Georeferencer georeferencer_;
};

}  // namespace

CalibrationViews view_calibration(const Context& context, const Geometry& before, const Geometry& after, const calib::TieSet& ties,
                                  const std::vector<calib::SurveyedTarget>& targets, const calib::LineHeightOptions& heights, double cell,
                                  size_t sections) {
  const Mapper old_way(context, before), new_way(context, after);
  CalibrationViews out;
  out.sections = calib::plan_sections(ties, new_way.map(), context.unit, sections);

  const Eigen::Vector3d metres(context.unit, context.unit, context.crs.vertical_metres_per_unit());
  constexpr double around = 2.0;  // m
  calib::CheckPoints checks(calib::check_points_of(targets,
                                                   [&](const Eigen::Vector3d& local) -> Eigen::Vector3d {
                                                     return new_way.map()(ties.frame.to_ecef(local)).cwiseProduct(metres);
                                                   }),
                            around);
  calib::LineHeights old_heights(heights, cell), new_heights(heights, cell);
  calib::SectionReturns old_sections(out.sections), new_sections(out.sections);
  stream_shots(context)([&](int line, const core::Shots& shots) {
    const core::Block was = old_way(shots), is = new_way(shots);
    old_heights.add(line, was);
    new_heights.add(line, is);
    old_sections.add(line, was);
    new_sections.add(line, is);
    checks.add(is);
  });
  out.before = calib::line_differences(old_heights);
  out.after = calib::line_differences(new_heights);
  for (size_t k = 0; k < out.sections.size(); ++k) {
    out.sections_before.push_back(old_sections.of(k));
    out.sections_after.push_back(new_sections.of(k));
  }
  out.checks = checks.residuals();
  return out;
}

}  // namespace swath::stages
