// SPDX-License-Identifier: GPL-3.0-or-later
// No published source. A mistake is believed where the lines fit with it far better than as described, or where it takes away what the
// returns and the trajectory contradict.
#include "calib/geometry/geometry_gate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "calib/geometry/geometry_control.h"
#include "calib/geometry/geometry_trial.h"
#include "calib/words.h"
#include "core/config/units.h"
#include "core/geo/geodesy.h"
#include "trajectory/checks.h"

namespace swath::calib {
namespace {

constexpr double far_better = 0.5;      // of the cost as described
constexpr double as_good = 1.12;        // of the best cost: the same
constexpr double fewer_cells = 0.1;     // of the largest number of cells that any assumption gives
constexpr double near_predicted = 2.5;  // of the predicted sigma
constexpr double few_outside = 0.1;
constexpr double no_worse = 1.02;    // of the cost as described, with a small mistake undone
constexpr double clearly_off = 1.5;  // of the predicted sigma: smaller differences are what the sigmas allow
constexpr double as_predicted = 1.25, less_left = 0.95;
constexpr size_t most_named = 3;
constexpr std::uint64_t few_cells = 5;
constexpr double least_covered = 0.5, nearly_all = 0.95, all_covered = 0.995;
constexpr double gross = 1.0;                     // m: no trajectory that is worth adjusting is so far off
constexpr double leap_fit = 1.0;                  // m: lines that are flown a kilometre apart do not come near this
constexpr double crossing = 0.15, meeting = 0.5;  // of the range: tracks so near share ground

/// At the ground below the first line that the trajectory covers, or below its middle.
trajectory::LocalFrame frame_of(const GeometryInput& in) {
  const core::TrajectoryData& d = in.trajectory->data();
  const size_t middle = d.size() / 2;
  core::Geodetic place{d.latitude[middle], d.longitude[middle], d.height[middle]};
  for (const RecordedLine& l : in.lines)
    if (const auto pose = in.trajectory->pose_at(0.5 * (l.first + l.last) + in.chain.calibration.latency.value)) {
      place = core::geodetic_of(pose->position);
      break;
    }
  place.height -= in.range;
  return trajectory::local_frame(core::ecef_of(place));
}

/// The mistakes that explain what was found, the best first.
std::vector<TriedMistake> explain(const GeometryFigures& found, std::uint64_t least, bool lines_apart) {
  const size_t now = not_held(found.checks);
  size_t fewest = now;
  // Lines that fit must fit as their sigmas say.
  const double sigma = std::max(found.lines.predicted, finest_difference);
  const auto fits = [&](const Fit& f) {
    return found.lines.predicted > 0 ? f.cost < near_predicted * sigma && f.outside < few_outside : f.rms < 0.3;
  };
  // Wider swaths share more ground, so that cells are counted of assumptions that fit, and of the flight as described.
  std::uint64_t most = found.lines.fit.cells;
  for (const TriedMistake& t : found.tried)
    if (fits(t.fit)) most = std::max(most, t.fit.cells);
  // A few cells that fit as described are evidence, too, though not enough to judge by: what fits them worse explains nothing.
  const Fit& as_is = found.lines.fit;
  const double must_fit = found.verdict == Verdict::not_judged && as_is.cells >= few_cells && fits(as_is)
                              ? as_good * std::max(as_is.cost, sigma)
                              : std::numeric_limits<double>::infinity();
  const auto enough = std::max(least, static_cast<std::uint64_t>(fewer_cells * static_cast<double>(most)));
  const bool by_lines = std::any_of(found.tried.begin(), found.tried.end(), [&](const TriedMistake& t) { return t.fit.cells >= enough; });
  const auto cost = [&](const Fit& f) { return !by_lines ? 1.0 : f.cells >= enough ? f.cost : 1e9; };
  double now_cost = cost(found.lines.fit);
  for (const TriedMistake& t : found.tried) fewest = std::min(fewest, t.contradictions);
  std::vector<TriedMistake> out;
  for (const TriedMistake& t : found.tried) {
    const bool near = !by_lines || (fits(t.fit) && t.fit.cost <= must_fit);
    const bool better = near && cost(t.fit) < far_better * now_cost;
    const bool resolves = t.contradictions < now && (!lines_apart || better) && cost(t.fit) <= as_good * now_cost;
    if (t.contradictions == fewest && (resolves || (lines_apart && better))) out.push_back(t);
  }
  std::stable_sort(out.begin(), out.end(), [&](const TriedMistake& x, const TriedMistake& y) { return cost(x.fit) < cost(y.fit); });
  // One offset of the times is one, however it was found.
  const auto is_offset = [](const TriedMistake& t) { return t.name == "time_offset"; };
  if (const auto first = std::find_if(out.begin(), out.end(), is_offset); first != out.end())
    out.erase(std::remove_if(first + 1, out.end(), is_offset), out.end());
  if (!out.empty()) {
    const double best = cost(out.front().fit);
    std::erase_if(out, [&](const TriedMistake& t) { return cost(t.fit) > as_good * best; });
  }
  if (out.size() > most_named) out.resize(most_named);
  return out;
}

/// Lines whose tracks meet share ground. Tracks side by side may not; then only a swath of another shape says that they ought to.
bool is_of_beams(const std::string& name, double nearest, double range) {
  return nearest < crossing * range || name == "scanner_model" || name == "scan_angle_degrees_as_radians";
}

bool is_apart(const LinePair& p, const GeometryOptions& o) {
  if (p.cells < static_cast<std::uint64_t>(o.min_cells)) return false;
  return (p.rms > o.ratio * p.predicted && p.rms > o.tolerance.value) || p.outside > o.outside;
}

/// Share of the lines' time, shifted, that a trajectory covers.
double covered_share(const std::vector<RecordedLine>& lines, const trajectory::Trajectory& t, double shift) {
  double all = 0, in = 0;
  for (const RecordedLine& l : lines) {
    all += l.last - l.first;
    for (const trajectory::Span& s : t.spans()) in += std::max(0.0, std::min(l.last + shift, s.last) - std::max(l.first + shift, s.first));
  }
  return all > 0 ? in / all : 0.0;
}

/// Time that the trajectory does not cover: would whole weeks or the leap seconds help?
void uncovered(const GeometryInput& in, GeometryFigures& out) {
  out.verdict = Verdict::inconsistent;
  out.warnings.push_back("the trajectory covers " + words("%.0f %%", 100 * out.covered) + " of the time of the flight lines");
  constexpr double week = 604800.0;
  const double middle = 0.5 * (in.trajectory->data().time.front() + in.trajectory->data().time.back());
  const double weeks = std::round((middle - in.lines.front().first) / week) * week;
  const double shift = in.chain.calibration.latency.value, leap = leap_seconds(in);
  const char* const scale = "state the time scale of laser and trajectory, GPS or UTC";
  const char* const zone = "state the time scale: local time and UTC differ by hours";
  std::vector<std::tuple<const char*, double, const char*>> offsets{
      {"gps_week", weeks, "state the week of laser and trajectory"}, {"leap_seconds", leap, scale}, {"leap_seconds", -leap, scale}};
  for (int half_hours = 1; half_hours <= 28; ++half_hours)
    for (const double sign : {1.0, -1.0}) offsets.emplace_back("time_offset", sign * 1800.0 * half_hours, zone);
  for (const auto& [name, offset, cure] : offsets) {
    if (offset == 0.0 || covered_share(in.lines, *in.trajectory, shift + offset) < nearly_all) continue;
    out.named.push_back(
        {name, "with the laser's times " + words("%.0f s ", std::abs(offset)) + (offset > 0 ? "later" : "earlier"), cure, {}, 0});
    return;
  }
}

std::string lines_of(const LinePair& p) { return "lines " + std::to_string(p.line_a) + " and " + std::to_string(p.line_b); }

void say(const SampledFlight& flight, const GeometryOptions& o, bool sound, bool unmet, GeometryFigures& out) {
  const LinePair* worst = nullptr;
  size_t apart = 0;
  for (const LinePair& p : out.lines.pairs)
    if (is_apart(p, o)) {
      ++apart;
      if (!worst || p.rms > worst->rms) worst = &p;
    }
  if (worst)
    out.warnings.push_back(lines_of(*worst) + " disagree by " + words("%.2f m (predicted %.2f m)", worst->rms, worst->predicted) +
                           words(" on smooth ground, %.0f %% of it by more than five times that", 100 * worst->outside) +
                           (apart > 1 ? words("; %.0f pairs of lines disagree", static_cast<double>(apart)) : ""));
  for (const GeometryCheck& c : out.checks)
    if (!c.held && !c.said) out.warnings.push_back(c.text);
  if (sound && out.covered < nearly_all)
    out.warnings.push_back("the trajectory covers " + words("%.0f %%", 100 * out.covered) + " of the time of the flight lines");
  else if (sound && !unmet && out.lines.fit.cells > 0 && !worst)
    out.warnings.push_back(
        "the differences of lines where they overlap" + words(" (%.3f m rms, predicted %.3f m)", out.lines.fit.rms, out.lines.predicted) +
        (out.control.compared >= fewest_control_points ? words(" and of the ground from control (%.3f m)", out.control.median) : "") +
        " have the pattern of an error of calibration");
  else if (sound && !worst)
    out.warnings.push_back((out.lines.fit.cells > 0
                                ? "only " + core::counted(out.lines.fit.cells, "cell of ground was", "cells of ground were")
                                : std::string("no ground was")) +
                           " found that two lines have seen, though their tracks come within " + words("%.0f m", flight.plan.nearest));
  for (const TriedMistake& t : out.named) {
    const bool lines = t.fit.cells > 0;
    out.warnings.push_back(
        t.what + (lines ? ", lines agree to " + words(t.fit.cost < 0.1 ? "%.3f m" : "%.2f m", t.fit.cost) : ", this is explained") + ": " +
        t.cure);
  }
}

/// A usual mistake and a gross contradiction are set right where they were made: an adjustment would bend the trajectory to hide them. A
/// value that was fitted is what calibration and adjustment are for.
std::string doubt_of(const GeometryFigures& g, const GeometryOptions& o) {
  for (const TriedMistake& t : g.named)
    if (t.usual) return t.what + " the flight fits: " + t.cure;
  for (const GeometryCheck& c : g.checks)
    if (!c.held && c.name != "control_height") return c.text;
  for (const LinePair& p : g.lines.pairs)
    if (p.cells >= static_cast<std::uint64_t>(o.min_cells) && p.rms > gross)
      return lines_of(p) + " disagree by " + words("%.2f m", p.rms) + " on smooth ground";
  return {};
}

/// Clear differences of the lines are brought down by far, or to about what is predicted. Smaller ones are what the sigmas allow: only
/// where those are small does their pattern show a mistake, which brings them down as well.
bool explains_lines(const Fit& with, const GeometryFigures& g, double tolerance) {
  const double sigma = std::max(g.lines.predicted, finest_difference), now = g.lines.fit.rms;
  if (now > clearly_off * sigma) return with.rms < std::max(far_better * now, as_predicted * sigma);
  return sigma < tolerance && with.cost < less_left * g.lines.fit.cost;
}

/// What the ground's heights differ from control by is evidence of its own.
bool is_control_off(const GeometryFigures& g) {
  return g.control.compared >= fewest_control_points && std::abs(g.control.median) > near_predicted * g.control.predicted;
}

/// Small mistakes that the lines' and the control's differences show; confirmed on the sample.
std::vector<TriedMistake> small_mistakes(const GeometryInput& in, const GeometryOptions& o, const SampledFlight& flight,
                                         const std::vector<UsualMistake>& usual, const LineCells& cells, const GeometryFigures& found) {
  const bool heights = found.control.compared >= fewest_control_points;
  const std::vector<ControlCell> none;
  if (found.verdict == Verdict::not_judged && !heights) return {};
  double speed = 0;
  for (const Pass& p : flight.plan.passes) speed = std::max(speed, p.speed);
  const auto explained = [&](const LineCells& of, const Chain& at) {
    const ShotGeometry geometry(at.scanner, at.calibration);
    const SmallErrors errors =
        small_errors({flight.sample, of.ground, of.pairs, heights ? of.control : none, geometry, in.sensor, *in.trajectory, flight.frame});
    return explain_small(errors, at, in.chain, usual, {in.range, speed}, heights, not_held(found.checks) > 0);
  };
  std::vector<SmallExplanation> all = explained(cells, in.chain);
  std::vector<TriedMistake> out;
  if (all.empty()) return out;
  // Where planes lie over one another, they show more truly what is left.
  const Chain nearer = all.front().chain;
  LineCells anew = line_cells(flight, nearer, *in.trajectory);
  fit_lines(flight, anew, nearer, *in.trajectory, found.lines.predicted);
  all = explained(anew, nearer);
  // The small difference of a single pair is one figure, to which many a value can be fitted.
  const auto judged = std::count_if(found.lines.pairs.begin(), found.lines.pairs.end(),
                                    [&](const LinePair& p) { return p.cells >= static_cast<std::uint64_t>(o.min_cells); });
  const bool little = judged < 2 && not_held(found.checks) == 0 && found.lines.fit.cost < near_predicted * found.lines.predicted;
  if (little) std::erase_if(all, [](const SmallExplanation& e) { return !e.usual; });
  // Where control alone is off, a mistake that does not set it right explains nothing.
  const size_t now = not_held(found.checks), most = now > 0 ? now - 1 : 0;
  const bool by_control = now > 0 || is_control_off(found);
  const Trial trial(in, o, flight, found, usual);
  for (const SmallExplanation& e : all)
    if (TriedMistake t = trial.judged(e); t.fit.cost <= no_worse * found.lines.fit.cost && t.contradictions <= most &&
                                          (by_control || explains_lines(t.fit, found, o.tolerance.value)))
      out.push_back(std::move(t));
  return out;
}

/// A flight whose lines do not fit, or whose records contradict one another.
void try_mistakes(const GeometryInput& in, const GeometryOptions& o, const SampledFlight& flight, const std::vector<UsualMistake>& usual,
                  bool apart, bool sound, GeometryFigures& out) {
  const Trial trial(in, o, flight, out, usual);
  const auto least = static_cast<std::uint64_t>(o.min_cells);
  std::vector<TriedMistake> tried;
  trial.usual(tried);
  trial.sampled_anew(tried);
  out.tried = std::move(tried);
  if (sound)
    std::erase_if(out.tried,
                  [&](const TriedMistake& t) { return t.fit.cells < 4 * least || !is_of_beams(t.name, flight.plan.nearest, in.range); });
  out.named = explain(out, least, apart || sound);
  if (!out.named.empty() || sound) return;
  tried.clear();
  trial.fitted(tried);
  out.tried.insert(out.tried.end(), tried.begin(), tried.end());
  out.named = explain(out, least, apart);
}

/// The trajectory covers part of the lines alone, and none fit one another as described: would leap seconds make it cover them all, and the
/// lines fit?
void try_leap(const GeometryInput& in, const GeometryOptions& o, const SampledFlight& flight, const std::vector<UsualMistake>& usual,
              GeometryFigures& out) {
  const Trial trial(in, o, flight, out, usual);
  trial.leap(out.tried);
  const double shift = in.chain.calibration.latency.value;
  for (const TriedMistake& t : out.tried) {
    const double leap = t.what.ends_with("later") ? leap_seconds(in) : -leap_seconds(in);
    if (covered_share(in.lines, *in.trajectory, shift + leap) > all_covered && t.fit.cells >= static_cast<std::uint64_t>(o.min_cells) &&
        t.fit.rms < leap_fit && t.contradictions <= not_held(out.checks))
      out.named.push_back(t);
  }
}

void add_control(const GeometryOptions& o, const ControlFigures& c, GeometryFigures& out) {
  out.control = {c.points, c.near, c.compared, c.nearest, c.median, c.predicted};
  if (const auto check = check_control(c, o.ratio, o.tolerance.value)) out.checks.push_back(*check);
}

/// The lines fit and nothing but control is off.
bool is_of_heights(const GeometryFigures& found) {
  return not_held(found.checks) > 0 &&
         std::all_of(found.checks.begin(), found.checks.end(), [](const GeometryCheck& c) { return c.held || c.name == "control_height"; });
}

}  // namespace

GeometryFigures judge_geometry(const GeometryInput& in, const GeometryOptions& o) {
  GeometryFigures out;
  if (in.lines.empty() || !(in.range > 0)) return out;
  const SampledFlight flight = std::move(sampled(in, o, frame_of(in), {{in.chain.calibration.latency.value, in.range}}).front());
  out.covered = flight.plan.covered;
  if (out.covered < least_covered) {
    uncovered(in, out);
    for (const TriedMistake& t : out.named) out.warnings.push_back(t.what + " it covers them: " + t.cure);
    return out;
  }
  LineCells cells = line_cells(flight, in.chain, *in.trajectory);
  out.lines = fit_lines(flight, cells, in.chain, *in.trajectory, 0.0);
  out.checks = check_returns(flight, in.chain, *in.trajectory, in.trajectory->data());
  const trajectory::MotionChecks said = trajectory::check_motion(in.trajectory->data(), trajectory::CheckOptions{}.min_speed);
  for (GeometryCheck& c : check_motion(trajectory::check_flight(in.trajectory->data()), said)) out.checks.push_back(std::move(c));
  const ControlFigures control = compare_control(flight, cells, in.chain, *in.trajectory);
  add_control(o, control, out);
  bool apart = false;
  for (const LinePair& p : out.lines.pairs) {
    if (p.cells >= static_cast<std::uint64_t>(o.min_cells)) out.verdict = Verdict::consistent;
    apart = apart || is_apart(p, o);
  }
  const bool sound = !apart && not_held(out.checks) == 0;
  const bool unmet = out.verdict == Verdict::not_judged && flight.plan.nearest < meeting * in.range;
  const std::vector<UsualMistake> usual = usual_mistakes(in.chain, in.convergence, in.antenna);
  const bool of_heights = !apart && !unmet && is_of_heights(out);
  if (of_heights)
    if (const auto h = height_mistake(control, in.undulation ? in.undulation() : std::nan(""), in.range, in.control_over_geoid))
      out.named.push_back({h->name, h->what, h->cure, {}, 0});
  if (out.named.empty() && (sound || of_heights)) out.named = small_mistakes(in, o, flight, usual, cells, out);
  if (sound && out.named.empty() && out.verdict != Verdict::consistent && out.covered < nearly_all) try_leap(in, o, flight, usual, out);
  if (out.named.empty() && (unmet || !sound)) try_mistakes(in, o, flight, usual, apart, sound, out);
  if (sound && out.named.empty()) {
    out.tried.clear();
    return out;
  }
  out.verdict = Verdict::inconsistent;
  say(flight, o, sound, unmet, out);
  out.doubt = doubt_of(out, o);
  return out;
}

}  // namespace swath::calib
