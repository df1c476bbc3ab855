// SPDX-License-Identifier: GPL-3.0-or-later
// The geometry of a flight judged before anything is made of it.
#include <algorithm>
#include <cmath>

#include "calib/control.h"
#include "calib/geometry_gate.h"
#include "core/error.h"
#include "core/geodesy.h"
#include "core/statistics.h"
#include "io/control.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/calibration_flight.h"
#include "stages/shot_source.h"

namespace swath::stages {
namespace {

constexpr size_t looked_at = 4096;  // returns of a line for the usual range

double usual_range(const Context& context) {
  std::vector<double> ranges;
  core::Tally of_the_reader;
  for (const Strip& strip : context.strips) {
    StripBatch batch;
    if (context.source->open(context, strip)->next(batch, looked_at, of_the_reader))
      ranges.insert(ranges.end(), batch.shots.range.begin(), batch.shots.range.end());
  }
  return core::median(std::move(ranges), 0.0);
}

/// Grid north of the map clockwise from true north at the trajectory's middle, rad.
double convergence_of(const Context& context) {
  if (context.crs.empty() || !context.crs.is_projected()) return 0.0;
  const core::TrajectoryData& d = context.trajectory->data();
  const size_t i = d.size() / 2;
  const double latitude = core::to_degrees(d.latitude[i]), longitude = core::to_degrees(d.longitude[i]);
  const core::Transform to_map(core::wgs84_geodetic(), context.crs);
  const Eigen::Vector3d way = to_map({longitude, latitude + 5e-4, d.height[i]}) - to_map({longitude, latitude - 5e-4, d.height[i]});
  return -std::atan2(way.x(), way.y());
}

/// Of the geoid above the ellipsoid at the trajectory's middle, m; NaN where PROJ has no grid of one.
double undulation_of(const Context& context) {
  const core::TrajectoryData& d = context.trajectory->data();
  const size_t i = d.size() / 2;
  const Eigen::Vector3d place(core::to_degrees(d.longitude[i]), core::to_degrees(d.latitude[i]), d.height[i]);
  try {
    return place.z() - core::Transform(core::wgs84_geodetic(), core::Crs("EPSG:4326+5773"))(place).z();
  } catch (const core::SystemError&) {
    throw;
  } catch (const core::Error&) {
    return std::nan("");
  }
}

/// Points on the ground. The smooth cell beside a roof's centre may lie on the ground below.
std::vector<calib::SurveyedPlace> control_of(const Context& context, core::Tally& tally) {
  std::vector<calib::SurveyedPlace> out;
  try {
    core::Tally of_others;  // stages that use control count what is wrong with its planes
    const core::TrajectoryData& d = context.trajectory->data();
    const size_t i = d.size() / 2;
    const trajectory::LocalFrame frame = trajectory::local_frame(core::ecef_of({d.latitude[i], d.longitude[i], d.height[i]}));
    for (const calib::SurveyedTarget& t : calib::surveyed_targets(io::read_control(context.survey, of_others), frame, of_others))
      if (t.is_point) out.push_back({frame.to_ecef(t.centre), t.control.empty() ? 0.0 : t.control.front().sigma, t.sigma_h});
  } catch (const core::SystemError&) {
    throw;
  } catch (const core::Error& e) {
    tally.count("control that could not be used: heights are not judged by it", e.what());
  }
  return out;
}

core::Value value_of(const calib::ControlNear& c) {
  core::Value v = core::Value::object();
  v["points"] = c.points;
  v["near"] = c.near;
  v["compared"] = c.compared;
  if (std::isfinite(c.nearest)) v["nearest_m"] = c.nearest;
  if (c.compared == 0) return v;
  v["median_m"] = c.median;
  v["predicted_m"] = c.predicted;
  return v;
}

core::Value value_of(const calib::Fit& f) {
  core::Value v = core::Value::object();
  v["cells"] = f.cells;
  v["rms_m"] = f.rms;
  v["outside"] = f.outside;
  v["cost"] = f.cost;
  v["smooth"] = f.smooth;
  return v;
}

core::Value value_of(const calib::LinePair& p) {
  core::Value v = core::Value::object();
  v["lines"].push(p.line_a);
  v["lines"].push(p.line_b);
  v["n"] = p.cells;
  v["median_m"] = p.median;
  v["rms_m"] = p.rms;
  v["predicted_m"] = p.predicted;
  v["outside"] = p.outside;
  if (p.water != 0.0) v["water_m"] = p.water;
  return v;
}

class GeometryJudge : public OptionStage<calib::GeometryOptions> {
 public:
  const Info& info() const override {
    static const Info info{
        "quality.geometry",
        "Judges the geometry of a flight on a sample of its returns: lines against one another, heights, headings, roll; "
        "where they do not fit, the usual mistakes are tried.",
        {Grain::survey},
        {},
        {},
        {Product::trajectory, Product::shots},
        {}};
    return info;
  }

  std::vector<std::filesystem::path> inputs(const io::Survey& survey) const override { return control_files(survey); }

  void run_survey(Context& context, core::Tally& tally, core::Value& findings) const override {
    calib::GeometryInput in;
    in.shots = stream_shots(context);
    for (const Strip& s : context.strips)
      if (std::isfinite(s.first_time)) in.lines.push_back({s.line, s.first_time, s.last_time, s.records});
    in.chain = {context.survey.scanner, context.survey.calibration};
    in.sensor = context.survey.sigma;
    in.trajectory = context.trajectory.get();
    in.range = usual_range(context);
    in.convergence = convergence_of(context);
    // What is computed from GNSS fixes here is the IMU's, or the antenna's by its lever arm.
    for (size_t k = 0; k < 3 && !context.gnss; ++k) in.antenna[static_cast<Eigen::Index>(k)] = context.survey.antenna.lever_arm[k].value;
    in.control = control_of(context, tally);
    in.undulation = [&context] { return undulation_of(context); };
    calib::GeometryFigures found;
    try {
      found = calib::judge_geometry(in, options);
    } catch (const core::SystemError&) {
      throw;
    } catch (const core::Error& e) {
      // Whatever keeps the flight from being judged is found by the stages that need it, or does not matter to them.
      tally.count("the geometry could not be judged", e.what());
    }
    count(found, tally);
    tell(found, findings["geometry"]);
  }

 private:
  static void count(const calib::GeometryFigures& found, core::Tally& tally) {
    for (const calib::LinePair& p : found.lines.pairs)
      if (p.water != 0.0)
        tally.count("pairs of lines whose level ground alone differs, by one height: water?",
                    "lines " + std::to_string(p.line_a) + " and " + std::to_string(p.line_b) + ": " +
                        core::format_number(std::round(p.water * 100) / 100) + " m");
    if (found.control.points > 0 && found.control.near == 0 && std::isfinite(found.control.nearest))
      tally.count("control of which no point lies near a flight line: its CRS, its axes?",
                  std::to_string(found.control.points) + " points, the nearest " +
                      core::format_number(std::round(found.control.nearest / 100) / 10) + " km from a track");
  }

  void tell(const calib::GeometryFigures& found, core::Value& out) const {
    constexpr const char* verdicts[] = {"not judged", "consistent", "inconsistent"};
    out["verdict"] = verdicts[static_cast<size_t>(found.verdict)];
    core::Value& named = out["named"] = core::Value::array();
    for (const calib::TriedMistake& t : found.named) named.push(t.name);
    double largest = 0.0;
    for (const calib::LinePair& p : found.lines.pairs)
      if (p.cells >= static_cast<std::uint64_t>(options.min_cells)) largest = std::max(largest, p.rms);
    if (largest > 0) out["line_difference"] = largest;
    // What the trajectory's reader has warned of is not said again, but counts.
    const auto said = std::count_if(found.checks.begin(), found.checks.end(), [](const auto& c) { return !c.held && c.said; });
    if (found.control.points > 0) out["control"] = value_of(found.control);
    out["contradictions"] = found.warnings.size() + static_cast<size_t>(said);
    out["covered"] = found.covered;
    out["predicted_m"] = found.lines.predicted;
    out["fit"] = value_of(found.lines.fit);
    core::Value& pairs = out["pairs"] = core::Value::array();
    for (const calib::LinePair& p : found.lines.pairs) pairs.push(value_of(p));
    core::Value& checks = out["checks"] = core::Value::object();
    for (const calib::GeometryCheck& c : found.checks) {
      checks[c.name]["value"] = c.value;
      checks[c.name]["held"] = c.held;
    }
    core::Value& tried = out["tried"] = core::Value::array();
    for (const calib::TriedMistake& t : found.tried) {
      core::Value one = value_of(t.fit);
      one["name"] = t.name;
      one["what"] = t.what;
      one["contradictions"] = t.contradictions;
      tried.push(std::move(one));
    }
    if (!found.doubt.empty()) out["doubt"] = found.doubt;
    core::Value& warnings = out["warnings"] = core::Value::array();
    for (const std::string& w : found.warnings) warnings.push(w);
  }
};

}  // namespace

std::unique_ptr<Stage> make_geometry() { return std::make_unique<GeometryJudge>(); }

}  // namespace swath::stages
