// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "calib/hangar.h"
#include "core/error.h"
#include "io/hangar_file.h"
#include "io/output_file.h"
#include "io/value_file.h"
#include "stages/adapters/adapters.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using calib::HangarResult;
using core::Value;

struct LeverArmOptions {
  bool hold_stations = false;
};

template <class V>
void describe(LeverArmOptions& o, V& v) {
  v.option("hold_stations", o.hold_stations, "Takes the stations as free of error. Only for comparison: the sigmas come out far too small.",
           "Jubanski et al.");
}

std::string name_of(io::HangarRole role) { return std::string(core::Choices<io::HangarRole>::names[static_cast<size_t>(role)]); }

Value vector_value(const Eigen::VectorXd& v) {
  Value out = Value::array();
  for (const double x : v) out.push(x);
  return out;
}

Value matrix_value(const Eigen::MatrixXd& m) {
  Value out = Value::array();
  for (Eigen::Index r = 0; r < m.rows(); ++r) out.push(vector_value(m.row(r).transpose()));
  return out;
}

Eigen::VectorXd sigmas(const Eigen::MatrixXd& covariance) { return covariance.diagonal().cwiseMax(0).cwiseSqrt(); }

Value told(const calib::StationResult& s) {
  Value v = Value::object();
  v["name"] = s.name;
  v["from"] = s.stated ? "stated coordinates" : "distances";
  v["position_m"] = vector_value(s.position);
  v["sigma_m"] = vector_value(sigmas(s.covariance));
  if (s.stated) return v;
  const calib::Resection& r = s.resection;
  v["redundancy"] = r.redundancy;
  if (r.redundancy > 0) v["variance_factor"] = r.variance_factor;
  v["covariance_multiplied_by"] = s.factor;
  if (r.mirror) {
    v["mirror"]["position_m"] = vector_value(*r.mirror);
    v["mirror"]["variance_factor"] = r.mirror_variance_factor;
  }
  Value& list = v["distances"] = Value::array();
  for (size_t i = 0; i < s.targets.size(); ++i) {
    Value one = Value::object();
    one["to"] = s.targets[i];
    one["residual_mm"] = 1e3 * r.residual[i];
    one["w"] = r.w[i];
    list.push(std::move(one));
  }
  return v;
}

Value told(const calib::PointResult& p) {
  Value v = Value::object();
  v["name"] = p.name;
  v["role"] = name_of(p.role);
  v["from"] = p.stated ? "stated coordinates" : "sights";
  v["position_m"] = vector_value(p.position);
  v["sigma_m"] = vector_value(sigmas(p.covariance));
  if (p.search.mirror) {
    v["mirror"]["position_m"] = vector_value(*p.search.mirror);
    v["mirror"]["variance_factor"] = p.search.mirror_variance_factor;
  }
  return v;
}

Value told(const HangarResult& r) {
  Value v = Value::object();
  Value& arms = v["lever_arms"] = Value::array();
  for (const calib::LeverArm& l : r.lever_arms) {
    Value one = Value::object();
    one["from"] = name_of(l.from);
    one["to"] = name_of(l.to);
    one["forward_right_down_m"] = vector_value(l.value);
    one["sigma_m"] = vector_value(sigmas(l.covariance));
    one["covariance_m2"] = matrix_value(l.covariance);
    arms.push(std::move(one));
  }
  v["survey_toml"] = calib::survey_lines(r);
  Value& axes = v["axes"] = Value::object();
  axes["roll_deg"] = core::to_degrees(r.axes.attitude.roll);
  axes["pitch_deg"] = core::to_degrees(r.axes.attitude.pitch);
  axes["heading_deg"] = core::to_degrees(r.axes.attitude.heading);
  axes["sigma_roll_deg"] = core::to_degrees(r.axes.sigma.x());
  axes["sigma_pitch_deg"] = core::to_degrees(r.axes.sigma.y());
  axes["sigma_heading_deg"] = core::to_degrees(r.heading_sigma);
  Value& points = v["points"] = Value::array();
  for (const calib::PointResult& p : r.points) points.push(told(p));
  if (r.adjusted) {
    Value& a = v["adjustment"] = Value::object();
    a["redundancy"] = r.adjusted->redundancy;
    if (r.adjusted->redundancy > 0) a["variance_factor"] = r.adjusted->variance_factor;
    a["covariance_multiplied_by"] = r.point_factor;
    a["iterations"] = r.adjusted->iterations;
  }
  Value& stations = v["stations"] = Value::array();
  for (const calib::StationResult& s : r.stations) stations.push(told(s));
  Value& sights = v["sights"] = Value::array();
  for (const calib::SightResult& s : r.sights) {
    Value one = Value::object();
    one["what"] = s.text;
    one["place"] = s.place;
    one["observed"] = s.observed;
    one["residual"] = s.residual;
    one["sigma"] = s.sigma;
    one["w"] = s.w;
    sights.push(std::move(one));
  }
  Value& warnings = v["warnings"] = Value::array();
  for (const std::string& w : r.warnings) warnings.push(w);
  return v;
}

class LeverArmStage : public OptionStage<LeverArmOptions> {
 public:
  const Info& info() const override {
    static const Info info{"calib.lever_arm",
                           "Lever arms of IMU, scanner and antenna by a hangar survey with a total station, with their covariance.",
                           {Grain::survey},
                           {},
                           {},
                           {},
                           {}};
    return info;
  }
  std::vector<std::string> products() const override { return {"lever_arm.json", "lever_arm.toml"}; }
  std::vector<fs::path> inputs(const io::Survey& survey) const override {
    const io::HangarSurvey hangar = read(survey);
    std::vector<fs::path> out = io::hangar_tables(hangar);
    out.insert(out.begin(), hangar.file);
    return out;
  }
  void check(const Context& context) const override { read(context.survey); }

  void run_survey(Context& context, core::Tally& tally, Value& findings) const override {
    const io::HangarSurvey hangar = read(context.survey);
    HangarResult result = calib::solve_hangar(hangar, options.hold_stations);
    if (options.hold_stations) result.warnings.push_back("the stations were held: every sigma is far too small");
    for (const std::string& w : result.warnings) tally.count("warnings of the hangar survey", w);
    findings = told(result);
    io::write_text_file(context.output / "lever_arm.json", io::to_json(findings));
    io::write_text_file(context.output / "lever_arm.toml", calib::survey_lines(result));
  }

 private:
  static io::HangarSurvey read(const io::Survey& survey) {
    if (!survey.hangar)
      throw core::usage_error("calib.lever_arm: the survey names no hangar file", survey.name,
                              "state hangar = \"hangar.toml\" in the survey (docs/lever-arm.md)");
    return io::read_hangar(io::resolve(survey, *survey.hangar));
  }
};

}  // namespace

std::unique_ptr<Stage> make_lever_arm() { return std::make_unique<LeverArmStage>(); }

}  // namespace swath::stages
