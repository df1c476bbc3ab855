// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/calibrate.h"

#include <algorithm>
#include <cmath>

#include "calib/adjust/parameter_words.h"
#include "calib/adjust/tie_normals.h"
#include "calib/words.h"
#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

constexpr double swinging = 0.25;  // of the move before, turned back
// For the progress: what the coarse match and the planes of a round take, in rounds, and how many rounds there usually are.
constexpr double coarse_rounds = 1.0, planes_part = 0.5, usual_rounds = 6.0;

/// What a change of the calibration moves the returns by at the tie planes, rms over the groups, m: for the reader.
double moved(const core::Calibration& from, const core::Calibration& to, const Adjustment& at, const trajectory::Trajectory& trajectory) {
  const auto change = [&](Parameter p) { return value_of(to, p) - value_of(from, p); };
  const double arm = std::hypot(change(lever_forward), change(lever_right), change(lever_down)), late = change(latency);
  double squares = 0;
  for (const GroupResidual& g : at.groups) {
    const double across = g.range * std::sin(g.angle);
    const double turned = change(boresight_roll) + change(scan_offset) + change(scan_scale) * g.angle;
    squares += std::pow(g.range * turned, 2) + std::pow(g.range * change(boresight_pitch), 2) +
               std::pow(across * change(boresight_heading), 2) + std::pow(change(range_offset) + g.range * change(range_scale), 2) +
               arm * arm;
    const auto pose = late != 0.0 ? trajectory.pose_at(g.time) : std::nullopt;
    if (pose) squares += std::pow(late * pose->velocity.norm(), 2);
  }
  return at.groups.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(at.groups.size()));
}

/// The estimated value that two rounds leave farthest apart, in its sigmas.
struct Move {
  Parameter parameter = boresight_roll;
  double sigmas = 0.0;
};
Move largest_move(const core::Calibration& from, const Adjustment& to) {
  Move out;
  for (const Estimate& e : to.estimates) {
    if (!e.estimated) continue;
    const double sigmas = std::abs(e.found - value_of(from, e.parameter)) / std::max(e.found_sigma, 1e-15);
    if (std::isnan(sigmas)) return {e.parameter, std::numeric_limits<double>::infinity()};
    if (sigmas >= out.sigmas) out = {e.parameter, sigmas};
  }
  return out;
}

/// All that was found, delivered or not: the planes are sought with it.
core::Calibration found_by(const Adjustment& a) {
  core::Calibration out = a.calibration;
  for (const Estimate& e : a.estimates)
    if (e.estimated) set_value(out, e.parameter, e.found);
  return out;
}

/// Where the next round looks for planes. A round that turns back much of what the one before moved swings about the answer: it is met half
/// way.
core::Calibration next_of(const core::Calibration& before, const core::Calibration& now, const Adjustment& a) {
  double product = 0.0, last = 0.0;
  core::Calibration found = found_by(a);
  for (const Estimate& e : a.estimates) {
    if (!e.estimated) continue;
    const double scale = std::max(e.found_sigma, 1e-15), was = (value_of(now, e.parameter) - value_of(before, e.parameter)) / scale;
    product += was * (e.found - value_of(now, e.parameter)) / scale;
    last += was * was;
  }
  if (product >= -swinging * last) return found;
  for (const Estimate& e : a.estimates)
    if (e.estimated) set_value(found, e.parameter, 0.5 * (e.found + value_of(now, e.parameter)));
  return found;
}

void refuse_unsettled(Adjustment& a, const Move& move, int rounds) {
  std::vector<Parameter> all;
  for (const Estimate& e : a.estimates)
    if (e.estimated) all.push_back(e.parameter);
  a.findings.push_back({"the values did not settle in " + core::counted(rounds, "round") + ": the last one still moved " +
                            std::string(words_of(move.parameter).name) + words(" by %.2g of its sigmas", move.sigmas),
                        "allow more rounds, or fly lines that share more planes: opposite lines, cross lines, sloping roofs", all, true});
  withdraw(a, all, Grade::unsettled);
}

/// How far the lines may lie apart at first: what the surfaces leave of the boresight moves returns by less from lower down.
double first_mismatch(double stated, double height) {
  constexpr double per_height = 1.0 / 800.0, least = 0.1;  // m
  return height > 0.0 ? std::min(stated, std::max(least, per_height * height)) : stated;
}

/// How far the lines still lie apart: three times the robust scatter of the groups about their planes.
double mismatch_after(const Adjustment& a) {
  std::vector<double> sizes;
  for (const GroupResidual& g : a.groups)
    if (!g.rejected) sizes.push_back(std::abs(g.after));
  return 3 * core::mad_to_sigma * core::median(std::move(sizes), 0.0);
}

/// The first round looks at few planes: it only leads to where the others begin. Sigmas by leaving out are not asked of it.
void make_quick(TiePlaneOptions& planes, AdjustOptions& adjusted) {
  planes.planes = std::max(300, *planes.planes / 4);
  planes.returns = std::max(planes.fewest, planes.returns / 3);
  adjusted.jackknife.lines = false;
  adjusted.jackknife.blocks = 0;
}

std::string about_metres(double v) { return words(v < 0.1 ? "%.3f m" : "%.2f m", v); }

/// Does the body's forward axis point against the velocity, most of the time? An IMU that is turned by 180 deg about the vertical exchanges
/// the sides, as a scan angle of the other sign does.
bool flies_backwards(const trajectory::Trajectory& trajectory) {
  constexpr size_t samples = 1000;
  constexpr double slowest = 1.0, backwards = -0.7;  // m/s; cosine, 45 deg
  const std::vector<double>& times = trajectory.data().time;
  std::vector<double> along;
  for (size_t k = 0; k < times.size(); k += std::max<size_t>(1, times.size() / samples))
    if (const auto pose = trajectory.pose_at(times[k]); pose && pose->velocity.norm() > slowest)
      along.push_back(pose->ecef_R_body.col(0).dot(pose->velocity.normalized()));
  return core::median(std::move(along), 0.0) < backwards;
}

[[noreturn]] void throw_reversed_scan(const trajectory::Trajectory& trajectory) {
  if (flies_backwards(trajectory))
    throw core::Error(
        "the surfaces of the lines do not meet, and the body's forward axis points against the flight: the IMU is turned by "
        "180 deg about the vertical",
        "trajectory",
        "turn heading of [[imu]] in survey.toml by 180 deg, or the signs of two of its axes; a given [[trajectory]] is to be "
        "exported with the heading of the craft's forward axis");
  throw core::Error("the surfaces of the lines meet only with the sign of the scan angle turned", "laser records",
                    "positive is to starboard: set laser.angle_to_port in survey.toml, or turn the sign of the column");
}

void refuse_without_ties(const TieSet& ties, const core::Tally& tally) {
  if (ties.planes.empty())
    refuse_without_planes(tally, ", and no surveyed target", "calibration flight", ": ground, roofs; see `planes` of the options");
}

}  // namespace

void refuse_reversed_scan(const CalibrationFlight& flight, const SurfaceMatchOptions& options) {
  if (scan_is_reversed(flight.shots, flight.scanner, flight.start, *flight.trajectory, flight.frame, sized(options, flight.scale.height)))
    throw_reversed_scan(*flight.trajectory);
}

std::vector<std::string> targets_not_found(const core::Tally& tally) {
  std::vector<std::string> out;
  if (tally.of("targets not found") == 0) return out;
  const core::Value counts = tally.value();
  for (const core::Value& example : counts.find("targets not found")->find("examples")->items())
    out.push_back("A surveyed target takes no part: " + example.as_text() + ".");
  return out;
}

trajectory::LocalFrame frame_of(const std::vector<std::pair<double, double>>& line_times, double height,
                                const trajectory::Trajectory& trajectory) {
  Vector3d sum = Vector3d::Zero();
  int n = 0;
  for (const auto& [first, last] : line_times)
    if (const auto pose = trajectory.pose_at(0.5 * (first + last))) {
      sum += pose->position;
      ++n;
    }
  if (n == 0)
    throw core::Error("the trajectory covers no flight line", "calibration flight",
                      "compare the time scales of laser and trajectory with `swath info`");
  core::Geodetic place = core::geodetic_of(sum / n);
  place.height -= height;
  return trajectory::local_frame(core::ecef_of(place));
}

Calibrated calibrate(const CalibrationFlight& flight, const CalibrateOptions& options, core::Tally& tally,
                     const core::OnProgress& progress) {
  Calibrated out;
  core::Calibration now = flight.start;
  const SurfaceMatchOptions match = sized(options.match, flight.scale.height);
  double mismatch = options.coarse ? first_mismatch(options.planes.mismatch.value, flight.scale.height) : options.planes.mismatch.value;
  if (options.coarse) {
    progress(0.0, "matching surfaces");
    out.match = match_surfaces(flight.shots, flight.scanner, flight.start, *flight.trajectory, flight.frame, match);
    if (out.match->scan_reversed) throw_reversed_scan(*flight.trajectory);
    now = out.match->calibration;
  } else {
    refuse_reversed_scan(flight, match);
  }

  std::vector<SurveyedTarget> targets;
  std::copy_if(flight.targets.begin(), flight.targets.end(), std::back_inserter(targets),
               [](const SurveyedTarget& t) { return t.use == io::ControlUse::control; });
  constexpr double closest = 0.05;  // m
  core::Tally of_round;
  core::Calibration before = now;
  for (out.rounds = 1; out.rounds <= options.rounds; ++out.rounds) {
    const bool first = out.rounds == 1 && options.rounds > 1;
    TiePlaneOptions planes = sized(options.planes, flight.scale);
    AdjustOptions adjusted = options.adjust;
    planes.mismatch.value = std::max(mismatch, closest);
    if (first) make_quick(planes, adjusted);
    const std::string round = "round " + std::to_string(out.rounds);
    const double done = coarse_rounds + out.rounds - 1;
    of_round = {};
    progress(core::usual_share(done, usual_rounds), round + ": planes");
    out.ties = find_tie_planes(flight.shots, flight.scanner, now, *flight.trajectory, flight.frame, targets, planes, of_round);
    refuse_without_ties(out.ties, of_round);
    progress(core::usual_share(done + planes_part, usual_rounds), round + ": adjustment");
    out.adjustment =
        adjust(out.ties, flight.scanner, flight.start, flight.sensor, *flight.trajectory, *flight.errors, adjusted, flight.threads);
    const Move move = largest_move(now, out.adjustment);
    const double change = moved(now, found_by(out.adjustment), out.adjustment, *flight.trajectory);
    const core::Calibration next = out.rounds > 2 ? next_of(before, now, out.adjustment) : found_by(out.adjustment);
    before = now;
    now = next;
    mismatch = std::min(mismatch, mismatch_after(out.adjustment));
    const bool settled = !first && move.sigmas <= settled_step;
    if (settled || out.rounds == options.rounds) {
      out.notes.push_back("Planes were sought " + core::counted(out.rounds, "time") + "; the last time moved the returns by " +
                          about_metres(change) + words(", and no value by more than %.2g of its sigmas.", move.sigmas));
      if (!settled) refuse_unsettled(out.adjustment, move, out.rounds);
      break;
    }
  }
  tally.add(of_round);
  for (std::string& note : targets_not_found(of_round)) out.notes.push_back(std::move(note));
  if (out.match) {
    for (const Finding& f : out.match->findings) out.notes.push_back("Surfaces: " + f.what + (f.cure.empty() ? "" : " (" + f.cure + ")"));
  }
  return out;
}

}  // namespace swath::calib
