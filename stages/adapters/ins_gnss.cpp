// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <optional>

#include "core/error.h"
#include "core/time.h"
#include "io/output_file.h"
#include "io/sbet.h"
#include "io/value_file.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/place.h"
#include "stages/drawing_file.h"
#include "stages/trajectory_charts.h"
#include "trajectory/checks.h"
#include "trajectory/compare.h"
#include "trajectory/ins_gnss.h"

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

class InsGnss : public OptionStage<InsGnssStageOptions> {
 public:
  const Info& info() const override {
    static const Info info{
        "trajectory.ins_gnss",
        "Smoothed trajectory from IMU and GNSS records: strapdown mechanisation, error-state Kalman filter, smoother; with "
        "its covariances, estimates of the sensors' errors and plots.",
        {Grain::survey},
        {},
        {},
        {Product::imu, Product::gnss},
        {Product::trajectory}};
    return info;
  }
  std::vector<std::string> products() const override {
    std::vector<std::string> out{"trajectory.json"};
    if (!options.plots.empty()) out.push_back("plots");
    return out;
  }
  std::vector<fs::path> inputs(const io::Survey& survey) const override {
    if (!survey.truth.trajectory) return {};
    return {io::resolve(survey, *survey.truth.trajectory)};
  }
  void check(const Context& context) const override {
    const core::ImuSpec& spec = context.survey.imu_spec;
    if (spec.grade == core::ImuGrade::unstated &&
        !(spec.angular_random_walk && spec.velocity_random_walk && spec.gyro_bias && spec.accelerometer_bias))
      throw core::usage_error("trajectory.ins_gnss: the survey does not say how good the IMU is", context.survey.name,
                              "state imu_spec.grade, or in [imu_spec] at least the two random walks and the two biases of its data sheet");
  }

  void run_survey(Context& context, core::Tally& tally, core::Value& findings) const override {
    const io::Antenna& antenna = context.survey.antenna;
    const Eigen::Vector3d lever_arm(antenna.lever_arm[0].value, antenna.lever_arm[1].value, antenna.lever_arm[2].value);
    core::ImuData imu = *context.imu;
    context.imu.reset();  // a record of hours is large, and no stage after this one reads it
    trajectory::InsGnssResult result =
        trajectory::smooth(std::move(imu), *context.gnss, context.survey.imu_spec.model(), lever_arm, antenna.lever_arm_sigma.value,
                           options, clocks_of(context.survey), context.progress);
    for (const auto& [key, value] : result.report.members())
      if (key != "warnings") findings[key] = value;
    if (const core::Value* warnings = result.report.find("warnings"); warnings && warnings->is_array())
      for (const core::Value& w : warnings->items()) tally.count(w.as_text());
    // Axes that are turned fit the fixes, but not the way the aircraft flies.
    trajectory::CheckOptions motion_alone;
    motion_alone.max_gap.value = std::numeric_limits<double>::infinity();
    for (const std::string& w : trajectory::check_trajectory(result.trajectory, motion_alone).warnings) tally.count(w);

    const auto errors = compare_with_truth(context, result.trajectory, result.report, findings);
    write_products(context, result, errors);
    trajectory::TrajectoryOptions interpolation;
    constexpr double steps = 2.5;  // of the trajectory's records; a longer one is a gap
    interpolation.max_gap.value = std::max(interpolation.max_gap.value, steps / options.output_rate.value);
    context.trajectory = std::make_shared<trajectory::Trajectory>(std::move(result.trajectory), interpolation, "trajectory.ins_gnss");
    place_on_map(context, tally);
  }

 private:
  /// Over all and over the flight lines, into the report and the findings.
  static std::optional<trajectory::TrajectoryErrors> compare_with_truth(const Context& context, const core::TrajectoryData& data,
                                                                        core::Value& report, core::Value& findings) {
    const auto truth = data.size() ? truth_of(context.survey, data.time.front()) : std::nullopt;
    if (!truth) return std::nullopt;
    trajectory::TrajectoryErrors errors = trajectory::errors_against(data, *truth);
    core::Value told = core::Value::object();
    if (errors.outside) told["outside_truth"] = errors.outside;
    told["all"] = trajectory::compare(errors).value();
    std::vector<trajectory::Span> lines;
    for (const io::LineWindow& w : io::line_windows(context.survey)) lines.push_back({w.start, w.end});
    if (!lines.empty()) told["lines"] = trajectory::compare(errors, lines).value();
    report["truth"] = told;
    findings["truth"] = std::move(told);
    return errors;
  }

  void write_products(const Context& context, const trajectory::InsGnssResult& result,
                      const std::optional<trajectory::TrajectoryErrors>& errors) const {
    io::write_text_file(context.output / "trajectory.json", io::to_json(result.report));
    if (options.plots.empty()) return;
    for (const NamedChart& c : trajectory_charts(result, *context.gnss, errors))
      for (const PlotFormat f : options.plots) {
        const std::string ending(core::Choices<PlotFormat>::names[static_cast<size_t>(f)]);
        write_drawing(context.output / "plots" / (c.name + "." + ending), report::drawing(c.chart));
      }
  }
};

}  // namespace

std::unique_ptr<Stage> make_ins_gnss() { return std::make_unique<InsGnss>(); }

}  // namespace swath::stages
