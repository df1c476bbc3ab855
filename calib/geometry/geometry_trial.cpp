// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/geometry_trial.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "calib/geometry/geometry_control.h"
#include "calib/words.h"
#include "core/error.h"
#include "core/time.h"

namespace swath::calib {
namespace {

constexpr double margin = 0.6;                 // s of the trajectory around a stretch ...
constexpr double steps_around = 2.5;           // ... and steps of it, for the cubic through four records
constexpr double longest_trial_offset = 20.0;  // s
constexpr size_t most_control = 500;           // surveyed places that are compared
// Stretches between lines of samples that are in memory together, in units of the flight's own: each, and all of them.
constexpr double largest_share = 0.5, largest_sum = 2.0;

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

}  // namespace

std::vector<SampledFlight> sampled(const GeometryInput& in, const GeometryOptions& o, const trajectory::LocalFrame& frame,
                                   const std::vector<SampleFor>& wanted) {
  std::vector<SampledFlight> out;
  std::vector<SurveyedHeight> control;
  std::vector<Eigen::Vector2d> spots;
  for (const SurveyedPlace& p : in.control) {
    control.push_back({frame.local_R_ecef * (p.ecef - frame.origin), p.sigma, p.horizontal});
    spots.push_back(control.back().place.head<2>());
  }
  const double share = wanted.size() > 1 ? std::min(largest_share, largest_sum / static_cast<double>(wanted.size())) : 1.0;
  const auto stretches = static_cast<size_t>(std::max(4.0, share * o.stretches));
  for (const SampleFor& w : wanted) {
    SampledFlight& f = out.emplace_back();
    f.frame = frame;
    f.sensor = in.sensor;
    SampleSize size;
    size.returns = o.returns;
    size.most_stretches = stretches;
    f.plan = plan_sample(in.lines, *in.trajectory, frame, w.shift, w.range, size, spots);
    f.ground = {f.plan.cell, 0.10 + 1e-4 * w.range};
    for (const size_t k : spots_seen(f.plan, w.range, spots, most_control)) f.control.push_back(control[k]);
  }
  std::vector<const SamplePlan*> plans;
  for (const SampledFlight& f : out) plans.push_back(&f.plan);
  std::vector<GeometrySample> samples = collect_samples(plans, in.shots);
  for (size_t k = 0; k < out.size(); ++k) out[k].sample = std::move(samples[k]);
  return out;
}

size_t not_held(const std::vector<GeometryCheck>& checks) {
  return static_cast<size_t>(std::count_if(checks.begin(), checks.end(), [](const GeometryCheck& c) { return !c.held; }));
}

double leap_seconds(const GeometryInput& in) { return core::gps_minus_utc_at_gps(in.lines.front().first); }

Trial::Trial(const GeometryInput& in, const GeometryOptions& o, const SampledFlight& flight, const GeometryFigures& found,
             const std::vector<UsualMistake>& mistakes)
    : in_(in), options_(o), flight_(flight), found_(found), mistakes_(mistakes), shift_(in.chain.calibration.latency.value) {
  const double step = longest_step(*in.trajectory);
  piece_ = cut_trajectory(in.trajectory->data(), flight.plan, shift_, std::max(margin, steps_around * step));
  how_.max_gap.value = 1.01 * step;
  whole_ = motion_of(in.trajectory->data());
  motion_ = not_held(check_motion(trajectory::check_flight(whole_)));
}

void Trial::usual(std::vector<TriedMistake>& out) const {
  for (const UsualMistake& m : mistakes_) {
    if (m.kind == UsualMistake::Kind::ranges) continue;
    Chain chain = in_.chain;
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

void Trial::sampled_anew(std::vector<TriedMistake>& out) const {
  std::vector<const UsualMistake*> ranges;
  for (const UsualMistake& m : mistakes_)
    if (m.kind == UsualMistake::Kind::ranges) ranges.push_back(&m);
  std::vector<SampleFor> wanted;
  std::vector<Chain> chains;
  for (const UsualMistake* m : ranges) {
    m->chain(chains.emplace_back(in_.chain));
    wanted.push_back({shift_, in_.range * chains.back().calibration.range_scale / in_.chain.calibration.range_scale});
  }
  const double leap = leap_seconds(in_);
  std::vector<double> offsets;
  if (leap > 0) offsets = {leap, -leap};
  const auto roll =
      roll_signal(flight_.sample.profiles, ShotGeometry(in_.chain.scanner, in_.chain.calibration), whole_, longest_trial_offset);
  const bool by_roll =
      roll && std::abs(roll->offset) > 0.3 && roll->best > roll->correlation + 0.15 && std::abs(std::abs(roll->offset) - leap) > 0.2;
  if (by_roll) offsets.push_back(roll->offset);
  for (const double offset : offsets) wanted.push_back({shift_ + offset, in_.range});
  std::vector<SampledFlight> flights;
  if (!could([&] { flights = sampled(in_, options_, flight_.frame, wanted); })) return;
  for (size_t k = 0; k < ranges.size(); ++k) {
    TriedMistake tried{std::string(ranges[k]->name), ranges[k]->what, ranges[k]->cure, {}, 0};
    if (could([&] { judge(flights[k], chains[k], *in_.trajectory, whole_, motion_, tried); })) out.push_back(std::move(tried));
  }
  for (size_t k = 0; k < offsets.size(); ++k) {
    SampledFlight& flight = flights[ranges.size() + k];
    if (by_roll && k + 1 == offsets.size())
      could([&] { follow(std::move(flight), offsets[k], 3, out); });
    else
      could([&] { out.push_back(offset_of(flight, "leap_seconds", offsets[k])); });
  }
}

void Trial::leap(std::vector<TriedMistake>& out) const {
  const double leap = leap_seconds(in_);
  if (!(leap > 0)) return;
  could([&] {
    const std::vector<SampledFlight> flights =
        sampled(in_, options_, flight_.frame, {{shift_ + leap, in_.range}, {shift_ - leap, in_.range}});
    out.push_back(offset_of(flights[0], "leap_seconds", leap));
    out.push_back(offset_of(flights[1], "leap_seconds", -leap));
  });
}

void Trial::fitted(std::vector<TriedMistake>& out) const {
  could([&] { follow(flight_, 0.0, 1, out); });
  constexpr int rounds = 8;
  constexpr double settled = 0.02;  // of the first step: planes that do not yet lie over one another pull too little
  for (size_t group = 0; group < fitted_groups(); ++group) {
    SmallExplanation found;
    found.chain = in_.chain;
    could([&] {
      for (int round = 0; round < rounds; ++round) {
        LineCells cells = line_cells(flight_, found.chain, *in_.trajectory);
        fit_lines(flight_, cells, found.chain, *in_.trajectory, found_.lines.predicted);
        const ShotGeometry geometry(found.chain.scanner, found.chain.calibration);
        const SmallErrors errors =
            small_errors({flight_.sample, cells.ground, cells.pairs, {}, geometry, flight_.sensor, *in_.trajectory, flight_.frame});
        if (errors.differences < static_cast<size_t>(options_.min_cells)) return;
        found = fit_small(errors, in_.chain, found.chain, group);
        if (found.name.empty() || found.step < settled) break;
      }
      if (!found.name.empty()) out.push_back(judged(found));
    });
  }
}

TriedMistake Trial::judged(const SmallExplanation& m) const {
  TriedMistake tried{m.name, m.what, m.cure, {}, 0, m.usual};
  judge(flight_, m.chain, *in_.trajectory, whole_, motion_, tried);
  return tried;
}

std::uint64_t Trial::enough() const {
  return std::max<std::uint64_t>(static_cast<std::uint64_t>(options_.min_cells), found_.lines.fit.cells / 8);
}

Chain Trial::later(double offset) const {
  Chain chain = in_.chain;
  chain.calibration.latency.value += offset;
  return chain;
}

/// The best offset near one for which a sample was read; where it lies at the sample's rim another one is read, up to `samples` in all.
void Trial::follow(SampledFlight flight, double centre, int samples, std::vector<TriedMistake>& out) const {
  constexpr double rim = 0.3;  // s
  double best = centre, width = 0.0;
  for (int round = 1; round <= samples; ++round) {
    const auto cost = [&](double offset) {
      const Chain chain = later(offset);
      LineCells cells = line_cells(flight, chain, *in_.trajectory);
      const Fit f = fit_lines(flight, cells, chain, *in_.trajectory, found_.lines.predicted).fit;
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
    if (round == samples || std::abs(best - centre) < rim) break;
    centre = best;
    flight = std::move(sampled(in_, options_, flight_.frame, {{shift_ + centre, in_.range}}).front());
  }
  if (best != 0.0) out.push_back(offset_of(flight, "time_offset", best));
}

TriedMistake Trial::offset_of(const SampledFlight& flight, const char* name, double offset) const {
  TriedMistake tried{name,
                     "with the laser's times " + words("%.4g s ", std::abs(offset)) + (offset > 0 ? "later" : "earlier"),
                     std::string(name) == "leap_seconds" ? "state the time scale of laser and trajectory, GPS or UTC"
                                                         : "state latency = \"" + words("%.4g s", shift_ + offset) + "\" in [calibration]",
                     {},
                     0,
                     std::string(name) == "leap_seconds"};
  judge(flight, later(offset), *in_.trajectory, whole_, motion_, tried);
  return tried;
}

void Trial::judge(const SampledFlight& flight, const Chain& chain, const trajectory::Trajectory& t, const core::TrajectoryData& whole,
                  size_t motion, TriedMistake& out) const {
  LineCells cells = line_cells(flight, chain, t);
  out.fit = fit_lines(flight, cells, chain, t, found_.lines.predicted).fit;
  out.contradictions = motion + not_held(check_returns(flight, chain, t, whole));
  if (const auto control = check_control(compare_control(flight, cells, chain, t), options_.ratio, options_.tolerance.value))
    out.contradictions += !control->held;
  else  // a swath that no longer reaches the control does not set right what is off there
    out.contradictions += static_cast<size_t>(std::count_if(found_.checks.begin(), found_.checks.end(),
                                                            [](const GeometryCheck& c) { return !c.held && c.name == "control_height"; }));
}

}  // namespace swath::calib
