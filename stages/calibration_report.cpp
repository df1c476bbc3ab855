// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/calibration_report.h"

#include <algorithm>
#include <cmath>
#include <system_error>

#include "io/geotiff.h"
#include "io/output_file.h"
#include "io/png.h"
#include "io/value_file.h"
#include "stages/adapters/units.h"
#include "stages/calibration/page.h"
#include "stages/calibration/tables.h"
#include "stages/calibration/verdict.h"

namespace swath::stages {

namespace {

/// Row by row.
std::vector<double> correlation_of(const Eigen::MatrixXd& covariance) {
  std::vector<double> out;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i)
    for (Eigen::Index j = 0; j < covariance.cols(); ++j) {
      const double scale = std::sqrt(std::max(0.0, covariance(i, i)) * std::max(0.0, covariance(j, j)));
      out.push_back(i == j ? 1.0 : scale > 0.0 ? std::clamp(covariance(i, j) / scale, -1.0, 1.0) : 0.0);
    }
  return out;
}

}  // namespace

DeliveredCalibration delivered(const calib::Adjustment& a, const core::SensorSigma& sensor) {
  DeliveredCalibration out{a.calibration, sensor};
  core::Calibration& c = out.calibration;
  core::SensorSigma& s = out.sigma;
  double lever = 0.0;
  for (int k = 0; k < estimated_count; ++k) {
    const calib::Estimate& e = a.estimates[static_cast<size_t>(k)];
    const bool good = is_delivered(a, parameter_at(k));
    if (!e.estimated) {
      if (k >= calib::lever_forward && k <= calib::lever_down) lever = std::max(lever, sensor.lever_arm.value);
      continue;
    }
    const double value = good ? e.value : e.start;
    // A start value that was to be estimated and could not: it is known as well as was stated for it.
    const auto known = [&](double stated) {
      return good                       ? e.sigma
             : std::isfinite(e.apriori) ? std::max(e.apriori, stated)
                                        : std::max(stated, std::hypot(e.found - e.start, e.found_sigma));
    };
    switch (parameter_at(k)) {
      case calib::boresight_roll:
        c.roll.value = value;
        s.roll.value = known(s.roll.value);
        break;
      case calib::boresight_pitch:
        c.pitch.value = value;
        s.pitch.value = known(s.pitch.value);
        break;
      case calib::boresight_heading:
        c.heading.value = value;
        s.heading.value = known(s.heading.value);
        break;
      case calib::lever_forward:
      case calib::lever_right:
      case calib::lever_down:
        c.lever_arm_scanner[static_cast<size_t>(k - calib::lever_forward)].value = value;
        lever = std::max(lever, known(sensor.lever_arm.value));
        break;
      case calib::range_offset:
        c.range_offset.value = value;
        s.range_offset.value = known(s.range_offset.value);
        break;
      case calib::range_scale:
        c.range_scale = value;
        s.range_scale = known(s.range_scale);
        break;
      case calib::scan_offset:
        c.scan_offset.value = value;
        s.scan_offset.value = known(s.scan_offset.value);
        break;
      case calib::scan_scale:
        c.scan_scale = value;
        s.scan_scale = known(s.scan_scale);
        break;
      default:
        c.latency.value = value;
        s.latency.value = known(s.latency.value);
    }
  }
  s.lever_arm.value = lever;
  s.correlation = correlation_of(calib::delivered_covariance(a));
  return out;
}

std::vector<std::string> write_calibration_report(const CalibrationReport& report, const std::filesystem::path& folder) {
  std::vector<std::string> written;
  const auto named = [&](const std::string& name) {
    written.push_back(name);
    std::error_code failed;  // what cannot be made is reported by the file that has no place
    std::filesystem::create_directories((folder / name).parent_path(), failed);
    return folder / name;
  };
  const auto text = [&](const char* name, const std::string& content) { io::write_text_file(named(name), content); };
  text("residuals.csv", residuals_csv(report));
  text("corrections.csv", corrections_csv(report));
  text("planes.csv", planes_csv(report));
  text("sections.csv", sections_csv(report));
  for (const LineDifference& d : report.differences)
    for (const bool before : {true, false})
      io::write_grid(named(difference_file(d, before)), in_units(report.unit, report.vertical_unit, before ? d.before : d.after),
                     report.crs);
  const std::string page = calibration_page(report, [&](const std::string& file, const core::Picture& picture) {
    const std::string bytes = io::png_bytes(picture, file);
    io::write_text_file(named(file), bytes);
    return bytes;
  });
  text("report.html", page);
  // Last: where it stands, the report beside it is whole.
  text(report.strips ? "strips.json" : "calibration.json", io::to_json(calibration_report_tree(report)));
  return written;
}

}  // namespace swath::stages
