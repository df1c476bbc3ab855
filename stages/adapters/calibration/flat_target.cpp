// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/flat_target_chart.h"

#include "io/raster/png.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "io/vector/control.h"
#include "stages/adapters/calibration/calibrations.h"

namespace swath::stages {

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

}  // namespace swath::stages
