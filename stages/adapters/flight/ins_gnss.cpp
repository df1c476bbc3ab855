// SPDX-License-Identifier: GPL-3.0-or-later
// The trajectory of a flight from its IMU and GNSS records, with its report, plots and, where truth is known, its errors.
#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/option.h"
#include "io/survey/survey.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "report/flight_charts.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/flight/smoothing.h"
#include "stages/drawing_file.h"
#include "stages/once.h"
#include "trajectory/checks.h"
#include "trajectory/compare.h"
#include "trajectory/ins/ins_gnss.h"

namespace swath::stages {

enum class PlotFormat { png, svg, pdf };

}  // namespace swath::stages

namespace swath::core {
template <>
struct Choices<stages::PlotFormat> {
  static constexpr std::array<std::string_view, 3> names{"png", "svg", "pdf"};
};
}  // namespace swath::core

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

struct InsGnssStageOptions : trajectory::InsGnssOptions {
  std::vector<PlotFormat> plots{PlotFormat::png, PlotFormat::svg};
};

template <class V>
void describe(InsGnssStageOptions& o, V& v) {
  describe(static_cast<trajectory::InsGnssOptions&>(o), v);
  v.option("plots", o.plots, "Formats of the plots in the folder plots; an empty list makes none.");
}

void write_products(const Output& to, const InsGnssStageOptions& o, const trajectory::InsGnssResult& result, const core::GnssData& gnss,
                    const std::optional<core::TrajectoryErrors>& errors) {
  io::write_text_file(to.folder / "trajectory.json", io::to_json(core::reported(result.report)));
  if (o.plots.empty()) return;
  for (const report::NamedChart& c : report::flight_charts(result.trajectory, result.series, gnss, errors))
    for (const PlotFormat f : o.plots) {
      const std::string ending(core::Choices<PlotFormat>::names[static_cast<size_t>(f)]);
      write_drawing(to.folder / "plots" / (c.name + "." + ending), report::drawing(c.chart));
    }
}

std::vector<std::string> ins_gnss_products(const InsGnssStageOptions& o) {
  std::vector<std::string> out{"trajectory.json"};
  if (!o.plots.empty()) out.push_back("plots");
  return out;
}

void expect_imu_spec(const Context& context, const InsGnssStageOptions&) { require_imu_spec(context.survey, "trajectory.ins_gnss"); }

Given<trajectory::Trajectory, trajectory::InsFigures> smooth_flight(core::ImuData imu, const core::GnssData& gnss, const io::Survey& survey,
                                                                    const InsGnssStageOptions& o, const Output& to,
                                                                    const core::OnProgress& progress, core::Tally& tally) {
  trajectory::InsGnssResult result = smooth_records(std::move(imu), gnss, survey, o, progress);
  for (const std::string& w : result.report.warnings) tally.count(w);
  // Axes that are turned fit the fixes, but not the way the aircraft flies.
  trajectory::CheckOptions motion_alone;
  motion_alone.max_gap.value = std::numeric_limits<double>::infinity();
  const trajectory::TrajectoryChecks checks = trajectory::check_trajectory(result.trajectory, motion_alone);
  for (const std::string& w : checks.warnings)
    if (std::find(checks.turned.begin(), checks.turned.end(), w) == checks.turned.end()) tally.count(w);
  for (const std::string& w : checks.turned) result.report.figures.named.push_back({"trajectory.motion", w});

  std::optional<core::TrajectoryErrors> errors;
  if (const auto truth = truth_of(survey, result.trajectory)) {
    errors = trajectory::errors_against(result.trajectory, *truth);
    result.report.figures.truth = compare_with_truth(survey, *errors);
  }
  write_products(to, o, result, gnss, errors);
  return {as_flown(std::move(result.trajectory), o.output_rate.value, "trajectory.ins_gnss"), std::move(result.report.figures)};
}

}  // namespace

Entry ins_gnss_stage() {
  return once<smooth_flight>(
      "trajectory.ins_gnss",
      "Smoothed trajectory from IMU and GNSS records: strapdown mechanisation, error-state Kalman filter, smoother; with "
      "its covariances, estimates of the sensors' errors and plots.",
      {.check = expect_imu_spec, .inputs = true_trajectory, .products = ins_gnss_products, .memory = memory_by<smoothing_memory>});
}

}  // namespace swath::stages
