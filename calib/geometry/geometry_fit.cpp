// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/geometry/geometry_fit.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "calib/words.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

constexpr double far_off = 5.0, cut = 20.0;           // sigmas
constexpr double lowest_land = -480.0;                // m, ellipsoidal: the shore of the Dead Sea
constexpr double highest_land = 9000.0;               // m
constexpr double least_down = 0.5;                    // share of returns below the aircraft: gorges and streets have walls
constexpr double heading_limit = 5.0 * core::degree;  // sideslip and changing winds make up to three degrees
constexpr double misfit_limit = 0.35;                 // of the airspeed
constexpr double climb_limit = 0.3;                   // off 1
// Turns: cars, boats and stabilised mounts lean little or outwards; a reversed sign or another axis leans as much as an aircraft.
constexpr double leaning = 0.5, clearly_leaning = 0.8;  // factor and correlation
// Slopes of the terrain move the tilt by 0.3 to 0.6 of the roll: only a sign is sure.
constexpr double lowest_tilt = -0.4, lowest_correlation = -0.3;
constexpr double clear = 0.7, clearly_more = 0.35;  // correlations of tilt and roll
constexpr size_t fewest_bins = 300;                 // for the time of the roll: fewer agree somewhere by chance
constexpr double longest_offset = 20.0;             // s
constexpr double sure = 5.0;                        // sigmas

void add_heights(const SampledFlight& f, const Chain& chain, const trajectory::Trajectory& t, std::vector<GeometryCheck>& out) {
  LocalPoints points(chain.scanner, chain.calibration, t, f.frame);
  PointColumns p;
  std::vector<double> heights, flown;
  double down = 0, n = 0;
  for (const PassSample& s : f.sample.profiles) {
    points.run(s.shots, p);
    const size_t step = std::max<size_t>(1, p.x.size() / 500);
    for (size_t i = 0; i < p.x.size(); i += step) {
      if (std::isnan(p.x[i])) continue;
      const auto place = points.place_at(s.shots.time[i]);
      if (!place) continue;
      heights.push_back(core::geodetic_of(f.frame.to_ecef({p.x[i], p.y[i], p.z[i]})).height);
      flown.push_back(core::geodetic_of(f.frame.to_ecef(place->scanner)).height);
      down += p.z[i] < place->scanner.z();
      n += 1;
    }
  }
  if (n < 100) return;
  const double share = down / n, height = core::median(std::move(heights), 0.0);
  const bool is_below = core::median(std::move(flown), 0.0) < lowest_land;
  out.push_back({"beams_down", share, share >= least_down, words("only %.0f %% of the returns lie below the aircraft", 100 * share)});
  out.push_back({"ground_height", height, height > lowest_land && height < highest_land,
                 words("the ground lies %.0f m above the ellipsoid, where no land is: %s", height,
                       is_below ? "the trajectory lies below all land; its heights may count down, or have another unit"
                                : "heights of the trajectory or ranges are wrong")});
}

void add_turns(const trajectory::FlightChecks& c, std::vector<GeometryCheck>& out) {
  if (const auto& roll = c.roll_turns)
    out.push_back({"roll_in_turns", roll->factor, roll->factor > -leaning || roll->correlation > -clearly_leaning,
                   words("in turns the roll is %.2f of that of a coordinated turn (1 is expected)", roll->factor)});
  if (const auto& pitch = c.pitch_turns) {
    const bool rolls = c.roll_turns && std::abs(c.roll_turns->factor) > leaning;
    out.push_back({"pitch_in_turns", pitch->factor,
                   rolls || std::abs(pitch->factor) < leaning || std::abs(pitch->correlation) < clearly_leaning,
                   words("in turns the pitch is %.2f of the roll of a coordinated turn (0 is expected)", pitch->factor)});
  }
}

/// Root of the squares of the median `middle` and of the robust scatter about it: the RMS of noise, of an offset, and of both.
double robust_rms(std::vector<double> d, double middle) {
  for (double& x : d) x = std::abs(x - middle);
  return std::hypot(middle, core::mad_to_sigma * core::median(std::move(d), 0.0));
}

}  // namespace

LineCells line_cells(const SampledFlight& f, const Chain& chain, const trajectory::Trajectory& t) {
  LocalPoints points(chain.scanner, chain.calibration, t, f.frame);
  LineCells out;
  out.ground = ground_of(f.sample, points, f.ground);
  for (size_t a = 0; a < out.ground.size(); ++a) {
    for (size_t b = a + 1; b < out.ground.size(); ++b)
      if (std::vector<SharedCell> shared = shared_cells(out.ground[a], out.ground[b], f.ground.cell); !shared.empty())
        out.pairs.push_back({a, b, std::move(shared)});
    for (size_t k = 0; k < f.control.size(); ++k)
      if (const GroundCell* c = cell_beside(out.ground[a], f.control[k].place, f.ground.cell)) {
        const Eigen::Vector2d off = (f.control[k].place - c->mean).head<2>();
        out.control.push_back({a, c, c->mean.z() + c->slope.dot(off) - f.control[k].place.z(),
                               std::hypot(f.control[k].sigma, c->slope.norm() * f.control[k].horizontal), k});
      }
  }
  return out;
}

LineFit fit_lines(const SampledFlight& f, LineCells& of, const Chain& chain, const trajectory::Trajectory& t, double predicted) {
  const ShotGeometry geometry(chain.scanner, chain.calibration);
  std::map<size_t, const core::Shots*> shots;
  for (const PassSample& s : f.sample.surfaces) shots[s.pass] = &s.shots;
  LineFit out;
  double outside = 0, squares = 0, robust = 0, expected = 0, n = 0, cells = 0, smooth = 0;
  for (const PassGround& g : of.ground) cells += static_cast<double>(g.cells), smooth += static_cast<double>(g.smooth.size());
  for (auto& [a, b, shared] : of.pairs) {
    LinePair p;
    p.pass_a = of.ground[a].pass, p.pass_b = of.ground[b].pass;
    p.line_a = f.plan.passes[p.pass_a].line, p.line_b = f.plan.passes[p.pass_b].line;
    p.predicted =
        predicted > 0 ? predicted : predicted_difference(shared, *shots[p.pass_a], *shots[p.pass_b], geometry, f.sensor, t, f.frame);
    const double sigma = std::max(p.predicted, finest_difference);
    p.water = take_out_water(shared, sigma).value_or(0.0);
    p.cells = shared.size();
    std::vector<double> d;
    double off = 0;
    for (const SharedCell& s : shared) {
      d.push_back(s.apart);
      const double size = std::abs(s.apart);
      off += size > far_off * sigma;
      squares += std::pow(std::min(size, cut * sigma), 2);
    }
    const auto count = static_cast<double>(shared.size());
    outside += off;
    p.outside = off / count;
    p.median = core::median(d, 0.0);
    p.rms = robust_rms(std::move(d), p.median);
    n += count;
    expected += count * p.predicted * p.predicted;
    robust += count * p.rms * p.rms;
    out.fit.cells += p.cells;
    out.pairs.push_back(p);
  }
  out.fit.smooth = cells > 0 ? smooth / cells : 0.0;
  if (out.fit.cells == 0) return out;
  out.predicted = std::sqrt(expected / n);
  out.fit.outside = outside / n;
  out.fit.cost = std::sqrt(squares / n);
  out.fit.rms = std::sqrt(robust / n);
  return out;
}

std::vector<GeometryCheck> check_returns(const SampledFlight& f, const Chain& chain, const trajectory::Trajectory& t,
                                         const core::TrajectoryData& data) {
  std::vector<GeometryCheck> out;
  add_heights(f, chain, t, out);
  const ShotGeometry geometry(chain.scanner, chain.calibration);
  const auto roll = roll_signal(f.sample.profiles, geometry, data, 0.0);
  if (!roll) return out;
  const bool tilts = roll->factor + sure * roll->sigma > lowest_tilt || roll->correlation > lowest_correlation;
  out.push_back({"ground_tilt", roll->factor, tilts,
                 words("the ground tilts across the swath by %.2f of the aircraft's roll (1 is expected)", roll->factor)});
  if (roll->correlation > clear || roll->bins < fewest_bins || f.sample.profiles.size() < 2) return out;
  const auto sought = roll_signal(f.sample.profiles, geometry, data, longest_offset);
  out.push_back({"roll_time", sought->offset, sought->best < clear || sought->best < roll->correlation + clearly_more,
                 words("the tilt of the ground follows the aircraft's roll with the laser's times %.2f s ", std::abs(sought->offset)) +
                     (sought->offset > 0 ? "later" : "earlier")});
  return out;
}

std::vector<GeometryCheck> check_motion(const trajectory::FlightChecks& c, const trajectory::MotionChecks& said) {
  std::vector<GeometryCheck> out;
  if (c.heading) {
    const trajectory::HeadingFit& h = *c.heading;
    const double bias = core::to_degrees(h.bias);
    out.push_back({"heading_bias", bias, std::abs(h.bias) < heading_limit || std::abs(h.bias) < sure * h.sigma,
                   words("the heading is %.1f deg off what track and wind allow (wind of %.0f m/s taken into account)", bias, h.wind)});
    out.push_back({"heading_misfit", h.misfit, h.misfit < misfit_limit,
                   words("the heading does not follow the track: %.0f %% of the speed is left with any wind", 100 * h.misfit)});
  }
  add_turns(c, out);
  if (c.climb) {
    const double off = std::abs(c.climb->factor - 1.0);
    out.push_back({"climb", c.climb->factor, off < climb_limit || off < sure * c.climb->sigma,
                   words("the heights change by %.2f of what the vertical velocities say (1 is expected)", c.climb->factor)});
  }
  for (GeometryCheck& k : out)
    k.said = (said.turns_contradict && k.name.ends_with("_in_turns")) || (said.heights_contradict && k.name == "climb");
  return out;
}

}  // namespace swath::calib
