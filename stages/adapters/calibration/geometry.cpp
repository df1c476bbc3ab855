// SPDX-License-Identifier: GPL-3.0-or-later
// The geometry of a flight judged before anything is made of it: what report.json says of it.
#include <algorithm>
#include <cmath>

#include "calib/geometry/geometry_gate.h"
#include "calib/ties/control.h"
#include "core/config/result.h"
#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/geo/undulation.h"
#include "core/statistics.h"
#include "io/vector/control.h"
#include "stages/adapters/adapters.h"
#include "stages/once.h"

namespace swath::stages {
namespace {

struct GeometryFindings {
  calib::GeometryFigures geometry;
};

template <class V>
void describe(const GeometryFindings& r, V& v) {
  v.table("geometry", r.geometry, "The judgement; in report.json it is the key geometry of the whole report.");
}

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
double convergence_of(const Context& context, const core::TrajectoryData& d) {
  if (context.crs.empty() || !context.crs.is_projected()) return 0.0;
  const size_t i = d.size() / 2;
  const double latitude = core::to_degrees(d.latitude[i]), longitude = core::to_degrees(d.longitude[i]);
  const core::Transform to_map(core::wgs84_geodetic(), context.crs);
  const Eigen::Vector3d way = to_map({longitude, latitude + 5e-4, d.height[i]}) - to_map({longitude, latitude - 5e-4, d.height[i]});
  return -std::atan2(way.x(), way.y());
}

/// Points on the ground, and whether heights of control count from a geoid or level.
struct GroundControl {
  std::vector<calib::SurveyedPlace> points;
  bool over_geoid = false;
};

/// The smooth cell beside a roof's centre may lie on the ground below: roofs are left out.
GroundControl control_of(const io::Survey& survey, const core::TrajectoryData& d, core::Tally& tally) {
  GroundControl out;
  try {
    core::Tally of_others;  // stages that use control count what is wrong with its planes
    const size_t i = d.size() / 2;
    const trajectory::LocalFrame frame = trajectory::local_frame(core::ecef_of({d.latitude[i], d.longitude[i], d.height[i]}));
    const std::vector<io::ControlPoint> read = io::read_control(survey, of_others);
    for (const io::ControlPoint& p : read) out.over_geoid = out.over_geoid || p.heights == core::Heights::vertical;
    for (const calib::SurveyedTarget& t : calib::surveyed_targets(read, frame, of_others))
      if (t.is_point) out.points.push_back({frame.to_ecef(t.centre), t.control.empty() ? 0.0 : t.control.front().sigma, t.sigma_h});
  } catch (const core::SystemError&) {
    throw;
  } catch (const core::Error& e) {
    tally.count("control that could not be used: heights are not judged by it", e.what());
  }
  return out;
}

void count(const calib::GeometryFigures& found, core::Tally& tally) {
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

GeometryFindings judge_flight(const Context& context, const trajectory::Trajectory& trajectory, const core::GnssData* fixes,
                              const georef::ShotStream& shots, const calib::GeometryOptions& o, core::Tally& tally) {
  calib::GeometryInput in;
  in.shots = shots;
  for (const Strip& s : context.strips)
    if (std::isfinite(s.first_time)) in.lines.push_back({s.line, s.first_time, s.last_time, s.records});
  in.chain = {context.survey.scanner, context.survey.calibration};
  in.sensor = context.survey.sigma;
  in.trajectory = &trajectory;
  in.range = usual_range(context);
  in.convergence = convergence_of(context, trajectory.data());
  // What is computed from GNSS fixes here is the IMU's, or the antenna's by its lever arm.
  for (size_t k = 0; k < 3 && fixes == nullptr; ++k) in.antenna[static_cast<Eigen::Index>(k)] = context.survey.antenna.lever_arm[k].value;
  GroundControl control = control_of(context.survey, trajectory.data(), tally);
  in.control = std::move(control.points);
  in.control_over_geoid = control.over_geoid;
  in.undulation = [&d = trajectory.data()] {
    const size_t middle = d.size() / 2;
    return core::undulation({core::to_degrees(d.longitude[middle]), core::to_degrees(d.latitude[middle])});
  };
  calib::GeometryFigures found;
  try {
    found = calib::judge_geometry(in, o);
  } catch (const core::SystemError&) {
    throw;
  } catch (const core::Error& e) {
    // Whatever keeps the flight from being judged is found by the stages that need it, or does not matter to them.
    tally.count("the geometry could not be judged", e.what());
  }
  count(found, tally);
  for (const calib::LinePair& p : found.lines.pairs)
    if (p.cells >= static_cast<std::uint64_t>(o.min_cells) && p.rms > 0)
      found.line_difference = std::max(found.line_difference.value_or(0.0), p.rms);
  return {std::move(found)};
}

}  // namespace

Entry geometry_stage() {
  return once<judge_flight>(
      "quality.geometry",
      "Judges the geometry of a flight on a sample of its returns: lines against one another, heights, headings, roll; "
      "where they do not fit, the usual mistakes are tried.",
      {.inputs = files_in<&io::Survey::control>});
}

}  // namespace swath::stages
