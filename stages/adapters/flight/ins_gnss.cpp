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
#include "core/error.h"
#include "core/time.h"
#include "io/records/sbet.h"
#include "io/survey/survey.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "report/flight_charts.h"
#include "stages/adapters/adapters.h"
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

/// The true trajectory of a simulated survey: an SBET, whose seconds of week are of the week that the flight begins in.
std::optional<trajectory::Trajectory> truth_of(const io::Survey& survey, double first) {
  if (!survey.truth.trajectory) return std::nullopt;
  const fs::path file = io::resolve(survey, *survey.truth.trajectory);
  const io::TimeTags time{core::TimeScale::gps_week, core::week_of(first), {}};
  core::Tally ignored;
  return trajectory::Trajectory(io::read_sbet(file, time, true, io::VelocityAxes::ignore, std::nullopt, ignored), {}, file.string());
}

/// The clock offsets that the survey states, where one holds for all IMU files.
trajectory::StatedClocks clocks_of(const io::Survey& survey) {
  trajectory::StatedClocks out;
  out.antenna_latency = survey.antenna.latency.value;
  if (!survey.imu.empty()) out.imu_offset = survey.imu.front().time.offset.value;
  for (const io::ImuFile& f : survey.imu)
    if (out.imu_offset && f.time.offset.value != *out.imu_offset) out.imu_offset.reset();
  return out;
}

/// Over all and over the flight lines.
trajectory::TruthComparison compare_with_truth(const io::Survey& survey, const core::TrajectoryErrors& errors) {
  trajectory::TruthComparison out{errors.outside, trajectory::compare(errors)};
  std::vector<trajectory::Span> lines;
  for (const io::LineWindow& w : io::line_windows(survey)) lines.push_back({w.start, w.end});
  if (!lines.empty()) out.lines = trajectory::compare(errors, lines);
  return out;
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

std::vector<fs::path> true_trajectory(const io::Survey& survey) {
  if (!survey.truth.trajectory) return {};
  return {io::resolve(survey, *survey.truth.trajectory)};
}

void expect_imu_spec(const Context& context, const InsGnssStageOptions&) {
  const core::ImuSpec& spec = context.survey.imu_spec;
  if (spec.grade == core::ImuGrade::unstated &&
      !(spec.angular_random_walk && spec.velocity_random_walk && spec.gyro_bias && spec.accelerometer_bias))
    throw core::usage_error("trajectory.ins_gnss: the survey does not say how good the IMU is", context.survey.name,
                            "state imu_spec.grade, or in [imu_spec] at least the two random walks and the two biases of its data sheet");
}

Given<trajectory::Trajectory, trajectory::InsFigures> smooth_flight(core::ImuData imu, const core::GnssData& gnss, const io::Survey& survey,
                                                                    const InsGnssStageOptions& o, const Output& to,
                                                                    const core::OnProgress& progress, core::Tally& tally) {
  const io::Antenna& antenna = survey.antenna;
  const Eigen::Vector3d lever_arm(antenna.lever_arm[0].value, antenna.lever_arm[1].value, antenna.lever_arm[2].value);
  trajectory::InsGnssResult result = trajectory::smooth(std::move(imu), gnss, survey.imu_spec.model(), lever_arm,
                                                        antenna.lever_arm_sigma.value, o, clocks_of(survey), progress);
  for (const std::string& w : result.report.warnings) tally.count(w);
  // Axes that are turned fit the fixes, but not the way the aircraft flies.
  trajectory::CheckOptions motion_alone;
  motion_alone.max_gap.value = std::numeric_limits<double>::infinity();
  for (const std::string& w : trajectory::check_trajectory(result.trajectory, motion_alone).warnings) tally.count(w);

  std::optional<core::TrajectoryErrors> errors;
  if (const auto truth = result.trajectory.size() ? truth_of(survey, result.trajectory.time.front()) : std::nullopt) {
    errors = trajectory::errors_against(result.trajectory, *truth);
    result.report.figures.truth = compare_with_truth(survey, *errors);
  }
  write_products(to, o, result, gnss, errors);
  trajectory::TrajectoryOptions interpolation;
  constexpr double steps = 2.5;  // of the trajectory's records; a longer one is a gap
  interpolation.max_gap.value = std::max(interpolation.max_gap.value, steps / o.output_rate.value);
  return {trajectory::Trajectory(std::move(result.trajectory), interpolation, "trajectory.ins_gnss"), std::move(result.report.figures)};
}

}  // namespace

Entry ins_gnss_stage() {
  return once<smooth_flight>(
      "trajectory.ins_gnss",
      "Smoothed trajectory from IMU and GNSS records: strapdown mechanisation, error-state Kalman filter, smoother; with "
      "its covariances, estimates of the sensors' errors and plots.",
      {.check = expect_imu_spec, .inputs = true_trajectory, .products = ins_gnss_products});
}

}  // namespace swath::stages
