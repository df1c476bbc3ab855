// SPDX-License-Identifier: GPL-3.0-or-later
// Calibration by a flat roof.
#include "calib/target/flat_target.h"
#include "calib/report/flat_target_chart.h"
#include "calib/report/flat_target_report.h"
#include "io/raster/png.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "io/vector/control.h"
#include "stages/adapters/adapters.h"
#include "stages/once.h"
#include "trajectory/ins/error_model.h"

namespace swath::stages {
namespace {

struct FlatTargetStageOptions : calib::FlatTargetOptions {
  trajectory::ErrorModelOptions errors;
};

template <class V>
void describe(FlatTargetStageOptions& o, V& v) {
  describe(static_cast<calib::FlatTargetOptions&>(o), v);
  v.table("errors", o.errors, "Errors of trajectories that state no covariances between instants.");
}

std::vector<std::string> flat_target_products(const FlatTargetStageOptions&) {
  return {"flat_target.json", "flat_target_readings.csv", "flat_target.png"};
}

calib::FlatTarget measure_flat_target(const io::Survey& survey, const trajectory::Trajectory& trajectory, const georef::ShotStream& shots,
                                      const FlatTargetStageOptions& o, const Output& to, core::Tally& tally) {
  const trajectory::ErrorModel errors(trajectory.data(), o.errors);
  calib::FlatTarget result = calib::analyse_flat_target(
      shots, survey.scanner, survey.calibration, survey.sigma, trajectory,
      [&errors](const std::vector<double>& times) { return errors.covariance(times); }, io::read_control(survey, tally), o, tally);
  io::write_text_file(to.folder / "flat_target.json", io::to_json(calib::value_of(result)));
  io::write_text_file(to.folder / "flat_target_readings.csv", calib::readings_csv(result));
  io::write_png(to.folder / "flat_target.png", report::draw(calib::chart_of(result)));
  return result;
}

}  // namespace

Entry flat_target_stage() {
  return once<measure_flat_target>(
      "calib.flat_target",
      "Calibration flight over a flat roof: its displacement in each line, and from it pitch, roll, heading and range "
      "offset, each from its own passes.",
      {.inputs = files_in<&io::Survey::control>, .products = flat_target_products});
}

}  // namespace swath::stages
