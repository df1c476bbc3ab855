// SPDX-License-Identifier: GPL-3.0-or-later
// No published source. A mistake is believed where the lines fit with it far better than as described, or where it takes away what the
// returns and the trajectory contradict.
#include "calib/geometry_gate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "core/geodesy.h"
#include "core/time.h"
#include "trajectory/checks.h"

namespace swath::calib {
namespace {

constexpr double far_better = 0.5;      // of the cost as described
constexpr double as_good = 1.12;        // of the best cost: the same
constexpr double fewer_cells = 0.1;     // of the largest number of cells that any assumption gives
constexpr double near_predicted = 2.5;  // of the predicted sigma
constexpr double few_outside = 0.1;
constexpr double less = 0.8, much_less = 0.67;  // of the cost as described, where lines differ by little
constexpr double more_than_predicted = 1.15;    // cost beside the predicted sigma from which small mistakes are looked for
constexpr size_t most_named = 3;
constexpr double margin = 0.6;           // s of the trajectory around a stretch ...
constexpr double steps_around = 2.5;     // ... and steps of it, for the cubic through four records
constexpr double longest_offset = 20.0;  // s
constexpr double least_covered = 0.5, nearly_all = 0.95;
constexpr double crossing = 0.15, meeting = 0.5;  // of the range: tracks so near share ground

std::string text_of(const char* format, double a, double b = 0.0) {
  char text[200];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

SampledFlight sampled(const GeometryInput& in, const GeometryOptions& o, const trajectory::LocalFrame& frame, double shift) {
  SampledFlight f;
  f.frame = frame;
  f.sensor = in.sensor;
  SampleSize size;
  size.returns = o.returns;
  size.most_stretches = static_cast<size_t>(o.stretches);
  f.plan = plan_sample(in.lines, *in.trajectory, frame, shift, in.range, size);
  f.sample = collect_sample(f.plan, in.shots);
  f.ground = {f.plan.cell, 0.10 + 1e-4 * in.range};
  return f;
}

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

size_t not_held(const std::vector<GeometryCheck>& checks) {
  return static_cast<size_t>(std::count_if(checks.begin(), checks.end(), [](const GeometryCheck& c) { return !c.held; }));
}

/// Longest step between records that is interpolated over.
double longest_step(const trajectory::Trajectory& t) {
  const std::vector<double>& time = t.data().time;
  double out = 1e-6;
  long hint = -1;
  for (size_t k = 1; k < time.size(); ++k) {
    const double step = time[k] - time[k - 1];
    if (step <= out) continue;
    if (const long at = t.interval_at(0.5 * (time[k] + time[k - 1]), hint); at >= 0) out = step, hint = at;
  }
  return out;
}

/// An error within one assumption leaves the others, and the flight as described, as they are; one of the system ends the run.
template <class F>
bool could(F&& work) {
  try {
    work();
    return true;
  } catch (const core::SystemError&) {
    throw;
  } catch (const core::Error&) {
    return false;
  }
}

/// The motion of a trajectory, up to 50 records a second: no sigmas, no covariances.
core::TrajectoryData motion_of(const core::TrajectoryData& d) {
  constexpr double least_step = 0.0195;  // s
  using D = core::TrajectoryData;
  D out;
  double last = -1e300;
  for (size_t i = 0; i < d.size(); ++i) {
    if (d.time[i] - last < least_step) continue;
    last = d.time[i];
    for (const auto c : {&D::time, &D::latitude, &D::longitude, &D::height, &D::roll, &D::pitch, &D::heading})
      (out.*c).push_back((d.*c)[i]);
    if (!d.has_velocity()) continue;
    for (const auto c : {&D::v_north, &D::v_east, &D::v_down}) (out.*c).push_back((d.*c)[i]);
  }
  return out;
}

/// GPS less UTC at the flight's date, s.
double leap_seconds(const GeometryInput& in) { return core::gps_minus_utc_at_gps(in.lines.front().first); }

class Trial {
 public:
  Trial(const GeometryInput& in, const GeometryOptions& o, const SampledFlight& flight, const GeometryFigures& found)
      : in_(in), options_(o), flight_(flight), found_(found), shift_(in.chain.calibration.latency.value) {
    const double step = longest_step(*in.trajectory);
    piece_ = cut_trajectory(in.trajectory->data(), flight.plan, shift_, std::max(margin, steps_around * step));
    how_.max_gap.value = 1.01 * step;
    whole_ = motion_of(in.trajectory->data());
    motion_ = not_held(check_motion(trajectory::check_flight(whole_)));
  }

  /// `small`: those alone that move returns by little.
  void usual(bool small, std::vector<TriedMistake>& out) const {
    for (const UsualMistake& m : usual_mistakes(in_.chain, in_.convergence)) {
      Chain chain = in_.chain;
      if (m.kind == UsualMistake::Kind::ranges || (small && m.kind != UsualMistake::Kind::small)) continue;
      if (m.chain) m.chain(chain);
      TriedMistake tried{std::string(m.name), m.what, m.cure, {}, 0};
      const bool judged = could([&] {
        if (!m.trajectory) return judge(flight_, chain, *in_.trajectory, whole_, motion_, tried);
        core::TrajectoryData part = piece_, whole = whole_;
        m.trajectory(part);
        m.trajectory(whole);
        judge(flight_, chain, trajectory::Trajectory(std::move(part), how_, "sample"), whole,
              not_held(check_motion(trajectory::check_flight(whole))), tried);
      });
      if (judged) out.push_back(std::move(tried));
    }
  }

  /// Mistakes of the ranges: another sample is read for each, as where lines lie beside one another depends on their widths.
  void ranges(std::vector<TriedMistake>& out) const {
    for (const UsualMistake& m : usual_mistakes(in_.chain, in_.convergence)) {
      if (m.kind != UsualMistake::Kind::ranges) continue;
      GeometryInput wide = in_;
      m.chain(wide.chain);
      wide.range *= wide.chain.calibration.range_scale / in_.chain.calibration.range_scale;
      TriedMistake tried{std::string(m.name), m.what, m.cure, {}, 0};
      if (could([&] { judge(sampled(wide, options_, flight_.frame, shift_), wide.chain, *in_.trajectory, whole_, motion_, tried); }))
        out.push_back(std::move(tried));
    }
  }

  /// Offsets of the laser's times near none, and near the one that the roll shows.
  void offsets(bool large, std::vector<TriedMistake>& out) const {
    could([&] { follow(flight_, 0.0, large, out); });
    if (!large) return;
    const double leap = leap_seconds(in_);
    const auto roll = roll_signal(flight_.sample.profiles, ShotGeometry(in_.chain.scanner, in_.chain.calibration), whole_, longest_offset);
    if (roll && std::abs(roll->offset) > 0.3 && roll->best > roll->correlation + 0.15 && std::abs(std::abs(roll->offset) - leap) > 0.2)
      could([&] { follow(sampled(in_, options_, flight_.frame, shift_ + roll->offset), roll->offset, true, out); });
    for (const double offset : {leap, -leap})
      if (leap > 0)
        could([&] { out.push_back(offset_of(sampled(in_, options_, flight_.frame, shift_ + offset), "leap_seconds", offset)); });
  }

 private:
  std::uint64_t enough() const {
    return std::max<std::uint64_t>(static_cast<std::uint64_t>(options_.min_cells), found_.lines.fit.cells / 4);
  }
  Chain later(double offset) const {
    Chain chain = in_.chain;
    chain.calibration.latency.value += offset;
    return chain;
  }

  /// The best offset near one for which a sample was read; where it lies at the sample's rim another one is read.
  void follow(SampledFlight flight, double centre, bool again, std::vector<TriedMistake>& out) const {
    constexpr int most_samples = 4;
    constexpr double rim = 0.3;  // s
    double best = centre, width = 0.0;
    for (int round = 0; round < most_samples; ++round) {
      const auto cost = [&](double offset) {
        const Fit f = fit_lines(flight, later(offset), *in_.trajectory, found_.lines.predicted).fit;
        return f.cells >= enough() ? f.cost : 1e9;
      };
      double least = cost(centre);
      best = centre;
      for (const double size : {0.003, 0.006, 0.012, 0.025, 0.05, 0.1, 0.2, 0.4})
        for (const double offset : {centre + size, centre - size})
          if (const double c = cost(offset); c < least) least = c, best = offset, width = 0.5 * size;
      for (int k = 0; k < 6; ++k, width *= 0.5)
        for (const double offset : {best - width, best + width})
          if (const double c = cost(offset); c < least) least = c, best = offset;
      if (!again || std::abs(best - centre) < rim) break;
      centre = best;
      flight = sampled(in_, options_, flight_.frame, shift_ + centre);
    }
    if (best != 0.0) out.push_back(offset_of(flight, "time_offset", best));
  }

  TriedMistake offset_of(const SampledFlight& flight, const char* name, double offset) const {
    TriedMistake tried{name,
                       "with the laser's times " + text_of("%.4g s ", std::abs(offset)) + (offset > 0 ? "later" : "earlier"),
                       std::string(name) == "leap_seconds"
                           ? "state the time scale of laser and trajectory, GPS or UTC"
                           : "state latency = \"" + text_of("%.4g s", shift_ + offset) + "\" in [calibration]",
                       {},
                       0};
    judge(flight, later(offset), *in_.trajectory, whole_, motion_, tried);
    return tried;
  }

  void judge(const SampledFlight& flight, const Chain& chain, const trajectory::Trajectory& t, const core::TrajectoryData& whole,
             size_t motion, TriedMistake& out) const {
    out.fit = fit_lines(flight, chain, t, found_.lines.predicted).fit;
    out.contradictions = motion + not_held(check_returns(flight, chain, t, whole));
  }

  const GeometryInput& in_;
  const GeometryOptions& options_;
  const SampledFlight& flight_;
  const GeometryFigures& found_;
  double shift_;
  core::TrajectoryData piece_, whole_;
  trajectory::TrajectoryOptions how_;
  size_t motion_ = 0;
};

/// Lines that differ by little: fewer cells are off by far, and the others by less.
bool is_clearly_less(const Fit& with, const Fit& without) {
  const double off = without.outside * static_cast<double>(without.cells), left = with.outside * static_cast<double>(with.cells);
  return with.cost < less * without.cost && (with.cost < much_less * without.cost || (off >= 8 && 4 * left <= off));
}

/// The mistakes that explain what was found, the best first.
std::vector<TriedMistake> explain(const GeometryFigures& found, std::uint64_t least, bool lines_apart, bool is_little) {
  const size_t now = not_held(found.checks);
  size_t fewest = now;
  std::uint64_t most = found.lines.fit.cells;
  for (const TriedMistake& t : found.tried) most = std::max(most, t.fit.cells);
  const auto enough = std::max(least, static_cast<std::uint64_t>(fewer_cells * static_cast<double>(most)));
  const bool by_lines = std::any_of(found.tried.begin(), found.tried.end(), [&](const TriedMistake& t) { return t.fit.cells >= enough; });
  // Lines that fit must fit as their sigmas say.
  const double sigma = std::max(found.lines.predicted, 0.03);
  const auto cost = [&](const Fit& f) { return !by_lines ? 1.0 : f.cells >= enough ? f.cost : 1e9; };
  double now_cost = cost(found.lines.fit);
  for (const TriedMistake& t : found.tried) fewest = std::min(fewest, t.contradictions);
  std::vector<TriedMistake> out;
  for (const TriedMistake& t : found.tried) {
    const bool near =
        !by_lines || (found.lines.predicted > 0 ? t.fit.cost < near_predicted * sigma && t.fit.outside < few_outside : t.fit.rms < 0.3);
    const bool better = near && (cost(t.fit) < far_better * now_cost || (is_little && is_clearly_less(t.fit, found.lines.fit)));
    const bool resolves = t.contradictions < now && (!lines_apart || better) && cost(t.fit) <= as_good * now_cost;
    if (t.contradictions == fewest && (resolves || (lines_apart && better))) out.push_back(t);
  }
  std::stable_sort(out.begin(), out.end(), [&](const TriedMistake& x, const TriedMistake& y) { return cost(x.fit) < cost(y.fit); });
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
  out.warnings.push_back("the trajectory covers " + text_of("%.0f %%", 100 * out.covered) + " of the time of the flight lines");
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
        {name, "with the laser's times " + text_of("%.0f s ", std::abs(offset)) + (offset > 0 ? "later" : "earlier"), cure, {}, 0});
    return;
  }
}

std::string lines_of(const LinePair& p) { return "lines " + std::to_string(p.line_a) + " and " + std::to_string(p.line_b); }

void say(const SampledFlight& flight, const GeometryOptions& o, bool sound, GeometryFigures& out) {
  const LinePair* worst = nullptr;
  size_t apart = 0;
  for (const LinePair& p : out.lines.pairs)
    if (is_apart(p, o)) {
      ++apart;
      if (!worst || p.rms > worst->rms) worst = &p;
    }
  if (worst)
    out.warnings.push_back(lines_of(*worst) + " disagree by " + text_of("%.2f m (predicted %.2f m)", worst->rms, worst->predicted) +
                           text_of(" on smooth ground, %.0f %% of it by more than five times that", 100 * worst->outside) +
                           (apart > 1 ? text_of("; %.0f pairs of lines disagree", static_cast<double>(apart)) : ""));
  for (const GeometryCheck& c : out.checks)
    if (!c.held && !c.said) out.warnings.push_back(c.text);
  if (sound && out.lines.fit.cells > 0 && !worst)
    out.warnings.push_back("lines differ by " + text_of("%.3f m rms (predicted %.3f m)", out.lines.fit.cost, out.lines.predicted) +
                           " where they overlap, more than need be");
  else if (sound && !worst)
    out.warnings.push_back("no ground was found that two lines have seen, though their tracks come within " +
                           text_of("%.0f m", flight.plan.nearest));
  for (const TriedMistake& t : out.named) {
    const bool lines = t.fit.cells > 0;
    out.warnings.push_back(
        t.what + (lines ? ", lines agree to " + text_of(t.fit.cost < 0.1 ? "%.3f m" : "%.2f m", t.fit.cost) : ", this is explained") +
        ": " + t.cure);
  }
}

}  // namespace

GeometryFigures judge_geometry(const GeometryInput& in, const GeometryOptions& o) {
  GeometryFigures out;
  if (in.lines.empty() || !(in.range > 0)) return out;
  const trajectory::LocalFrame frame = frame_of(in);
  const SampledFlight flight = sampled(in, o, frame, in.chain.calibration.latency.value);
  out.covered = flight.plan.covered;
  if (out.covered < least_covered) {
    uncovered(in, out);
    for (const TriedMistake& t : out.named) out.warnings.push_back(t.what + " it covers them: " + t.cure);
    return out;
  }
  out.lines = fit_lines(flight, in.chain, *in.trajectory, 0.0);
  out.checks = check_returns(flight, in.chain, *in.trajectory, in.trajectory->data());
  const trajectory::MotionChecks said = trajectory::check_motion(in.trajectory->data(), trajectory::CheckOptions{}.min_speed);
  for (GeometryCheck& c : check_motion(trajectory::check_flight(in.trajectory->data()), said)) out.checks.push_back(std::move(c));
  bool apart = false;
  size_t judged = 0;  // pairs
  for (const LinePair& p : out.lines.pairs) {
    if (p.cells >= static_cast<std::uint64_t>(o.min_cells)) out.verdict = Verdict::consistent, ++judged;
    apart = apart || is_apart(p, o);
  }
  const bool sound = !apart && not_held(out.checks) == 0;
  const bool unmet = out.verdict == Verdict::not_judged && flight.plan.nearest < meeting * in.range;
  const Fit& fit = out.lines.fit;
  // The small difference of a single pair is one figure, which many a small mistake explains.
  const bool little = sound && judged > 1 && fit.cost > more_than_predicted * out.lines.predicted;
  if (sound && !unmet && !little) return out;
  const Trial trial(in, o, flight, out);
  std::vector<TriedMistake> tried;
  trial.usual(little, tried);
  trial.offsets(!little, tried);
  if (!little) trial.ranges(tried);
  out.tried = std::move(tried);
  const auto least = static_cast<std::uint64_t>(o.min_cells);
  if (unmet && sound)
    std::erase_if(out.tried,
                  [&](const TriedMistake& t) { return t.fit.cells < 4 * least || !is_of_beams(t.name, flight.plan.nearest, in.range); });
  out.named = explain(out, least, apart || sound, little);
  if (sound && out.named.empty()) {
    out.tried.clear();
    return out;
  }
  out.verdict = Verdict::inconsistent;
  say(flight, o, sound, out);
  return out;
}

}  // namespace swath::calib
