// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/flat_target.h"

#include "calib/report/flat_target_report.h"
#include "io/control.h"
#include "io/output_file.h"
#include "io/png.h"
#include "io/value_file.h"
#include "report/chart.h"
#include "stages/adapters/adapters.h"
#include "stages/shot_source.h"
#include "trajectory/error_model.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

struct FlatTargetStageOptions : calib::FlatTargetOptions {
  trajectory::ErrorModelOptions errors;
};

template <class V>
void describe(FlatTargetStageOptions& o, V& v) {
  describe(static_cast<calib::FlatTargetOptions&>(o), v);
  v.table("errors", o.errors, "Errors of trajectories that state no covariances between instants.");
}

class FlatTargetStage : public OptionStage<FlatTargetStageOptions> {
 public:
  const Info& info() const override {
    static const Info info{"calib.flat_target",
                           "Calibration flight over a flat roof: its displacement in each line, and from it pitch, roll, heading and range "
                           "offset, each from its own passes.",
                           {Grain::survey},
                           {},
                           {},
                           {Product::trajectory, Product::shots},
                           {}};
    return info;
  }
  std::vector<std::string> products() const override { return {"flat_target.json", "flat_target_readings.csv", "flat_target.png"}; }
  std::vector<fs::path> inputs(const io::Survey& survey) const override {
    std::vector<fs::path> out;
    for (const io::ControlFile& f : survey.control) out.push_back(io::resolve(survey, f.file));
    return out;
  }

  void run_survey(Context& context, core::Tally& tally, core::Value& findings) const override {
    const io::Survey& survey = context.survey;
    const trajectory::ErrorModel errors(context.trajectory->data(), options.errors);
    const calib::FlatTarget result = calib::analyse_flat_target(
        stream_shots(context), survey.scanner, survey.calibration, survey.sigma, *context.trajectory,
        [&errors](const std::vector<double>& times) { return errors.covariance(times); }, io::read_control(survey, tally), options, tally);
    findings = calib::summary_of(result);
    io::write_text_file(context.output / "flat_target.json", io::to_json(calib::value_of(result)));
    io::write_text_file(context.output / "flat_target_readings.csv", calib::readings_csv(result));
    io::write_png(context.output / "flat_target.png", report::draw(calib::chart_of(result)));
  }
};

}  // namespace

std::unique_ptr<Stage> make_flat_target() { return std::make_unique<FlatTargetStage>(); }

}  // namespace swath::stages
