// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/adjust_results.h"

#include <algorithm>
#include <cmath>

#include "calib/adjust/short_waves.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;

constexpr size_t most_samples = 20000;

void put_counts(const TieProblem& p, const AdjustRounds& r, Adjustment& out) {
  const auto globals = static_cast<Eigen::Index>(p.globals.size());
  out.iterations = r.rounds;
  out.converged = r.converged;
  const Eigen::VectorXd variance = r.solution.of_globals(static_cast<int>(globals)).diagonal();
  for (Eigen::Index i = 0; i < globals; ++i)
    out.last_step = std::max(out.last_step, std::abs(r.solution.x[i]) / std::sqrt(std::max(1e-300, variance[i])));
  double sum = 0.0, freedom = 0.0;
  for (size_t g = 0; g < r.pass.blocks.size(); ++g) {
    const GroupBlock& b = r.pass.blocks[g];
    out.rejected_returns += b.rejected;
    if (!r.use.group[g]) {
      out.rejected_returns += b.used;
      continue;
    }
    out.observations += b.used;
    sum += r.system().block(g).c / p.robust.consistency();
  }
  freedom = static_cast<double>(out.observations);
  for (size_t c = 0; c < r.use.control.size(); ++c) {
    if (!r.use.control[c]) continue;
    ++out.observations;
    freedom += 1.0;
    const ControlRow& row = r.system().control()[c];
    sum += row.f * row.f / (row.sigma * row.sigma);
  }
  // The corrections' prior values are as many observations as there are corrections.
  if (r.state.correction.size() > 0) sum += r.prior->squares();
  out.unknowns = static_cast<std::uint64_t>(p.size()) + 3 * r.state.planes.size();
  freedom -= static_cast<double>(globals) + 3.0 * static_cast<double>(r.state.planes.size());
  out.sigma0 = freedom > 0.0 ? std::sqrt(sum / freedom) : not_known;
}

void put_components(const TieProblem& p, const AdjustRounds& r, const core::SensorSigma& noise, double surface_sigma, Adjustment& out) {
  const SigmaFactors& f = r.factors;
  const CorrectionKnots& knots = *p.knots;
  double control = 0.0;
  const std::vector<ControlRow> rows = control_rows(r.state.planes, 1.0);
  for (const ControlRow& row : rows) control += row.sigma * row.sigma;
  const auto add = [&](const std::string& name, double stated, const SigmaFactor& s) {
    out.components.push_back({name, stated, s.factor, s.redundancy, s.estimated});
  };
  add("range", noise.range.value, f.range);
  add("angle", std::hypot(noise.scan_angle.value, noise.beam_divergence.value / 4.0), f.angle);
  add("surface", surface_sigma, f.surface);
  for (const bool position : {true, false}) {
    const auto rms = [&](std::optional<CorrectionScale> scale) { return std::sqrt(knots.mean_square(position, scale)); };
    const double whole = rms({});
    if (whole == 0.0) continue;
    const std::array<SigmaFactor, 3>& of = position ? f.position : f.attitude;
    const std::string name = position ? "trajectory position" : "trajectory attitude";
    if (!knots.scales_apart()) {
      add(name, whole, of[0]);
      continue;
    }
    add(name + ", mean of a line", rms(line_mean), of[line_mean]);
    add(name + ", drift along a line", rms(line_drift), of[line_drift]);
    add(name + ", within a line", rms(within_line), of[within_line]);
  }
  if (!rows.empty()) add("control", std::sqrt(control / static_cast<double>(rows.size())), f.control);
}

void put_corrections(const TieProblem& p, const AdjustRounds& r, const HeldEffects& held, Adjustment& out) {
  const auto globals = static_cast<Eigen::Index>(p.globals.size());
  const CorrectionKnots& k = *p.knots;
  const TieSet& ties = *p.ties;
  const CorrectionKnots::PriorOf apriori = k.prior(r.factors.of_position(), r.factors.of_attitude());
  for (size_t l = 0; l < ties.lines.size(); ++l) {
    LineCorrection c;
    c.line = ties.lines[l].id;
    for (const double t : k.size() > 0 ? k.times(l) : std::vector<double>{}) {
      std::vector<int> numbers;
      const MatrixXd D = k.derivatives(l, t, numbers);
      const auto sigmas = [&](const MatrixXd& C) {
        std::array<double, 6> s{};
        const MatrixXd V = D * C * D.transpose();
        for (int i = 0; i < 6; ++i) s[i] = std::sqrt(std::max(0.0, V(i, i)));
        return s;
      };
      std::vector<int> unknowns = numbers;
      for (int& n : unknowns) n += static_cast<int>(globals);
      const Correction v = k.at(l, t, r.state.correction);
      c.time.push_back(t);
      c.value.push_back({v[0], v[1], v[2], v[3], v[4], v[5]});
      c.sigma.push_back(sigmas(r.solution.covariance(unknowns) + held.covariance(unknowns)));
      c.apriori.push_back(sigmas(apriori(numbers)));
      c.response.push_back(Eigen::Matrix<double, 6, latency + 1>::Zero());
      for (size_t h = 0; h < held.parameters.size(); ++h)
        for (Eigen::Index i = 0; i < D.cols(); ++i)
          c.response.back().col(held.parameters[h]) +=
              D.col(i) * (held.effect(globals + numbers[static_cast<size_t>(i)], static_cast<Eigen::Index>(h)) /
                          held.sigma[static_cast<Eigen::Index>(h)]);
    }
    out.corrections.push_back(std::move(c));
  }
}

void put_planes(const AdjustRounds& r, Adjustment& out) {
  out.planes = r.state.planes;
  for (const PlaneRest& rest : r.rests)
    out.plane_sigma.push_back(plane_covariance(rest, r.solution.covariance(rest.index)).diagonal().cwiseSqrt());
}

void put_groups(const TieProblem& p, const AdjustRounds& r, Adjustment& out) {
  const TieSet& ties = *p.ties;
  for (size_t g = 0; g < ties.groups.size(); ++g) {
    const GroupBlock& b = r.pass.blocks[g];
    GroupResidual one;
    one.plane = ties.groups[g].plane;
    one.line = ties.groups[g].line;
    one.returns = b.used;
    one.time = b.time;
    one.angle = b.angle;
    one.range = b.range;
    one.before = r.before[g];
    if (b.used > 0) {
      one.after = -b.b[static_cast<Eigen::Index>(b.index.size())] / b.weight();
      one.rms = std::sqrt(b.c / b.weight());
    }
    one.redundancy = r.tests.group[g].redundancy;
    one.w = r.tests.group[g].w;
    one.rejected = !r.use.group[g];
    out.groups.push_back(one);
  }
  if (p.knots->size() > 0 && p.knots->spacing() > 0.0) out.waves_between = short_waves(out.groups, 0.5 * p.knots->spacing()).seen();
}

void put_control(const AdjustRounds& r, Adjustment& out) {
  size_t c = 0;
  for (size_t k = 0; k < r.state.planes.size(); ++k)
    for (const PlaneControl& control : r.state.planes[k].control) {
      const ControlRow& row = r.system().control()[c];
      out.control.push_back({control.name, static_cast<std::uint32_t>(k), row.f, row.sigma, r.tests.control[c].redundancy,
                             r.tests.control[c].w, !r.use.control[c]});
      ++c;
    }
}

void put_samples(const TieProblem& p, const AdjustRounds& r, Adjustment& out) {
  const TieSet& ties = *p.ties;
  size_t returns = 0;
  for (size_t g = 0; g < ties.groups.size(); ++g)
    if (r.use.group[g]) returns += ties.groups[g].end - ties.groups[g].begin;
  const size_t step = std::max<size_t>(1, (returns + most_samples - 1) / most_samples);
  const ShotGeometry geometry(*p.scanner, r.state.calibration);
  const TieNoise noise = r.noise();
  trajectory::Cursor cursor(*p.trajectory);
  size_t next = 0;
  for (size_t g = 0; g < ties.groups.size(); ++g) {
    if (!r.use.group[g]) continue;
    for (size_t i = ties.groups[g].begin; i < ties.groups[g].end; ++i, ++next) {
      Condition at;
      if (next % step != 0 || !condition_of(p, geometry, r.state, noise, cursor, ties.groups[g], i, at)) continue;
      out.samples.push_back({static_cast<std::uint32_t>(g), geometry.time(ties.returns.time[i]), geometry.angle(ties.returns.angle[i]),
                             geometry.range(ties.returns.range[i]), at.f, std::sqrt(at.variance())});
    }
  }
}

}  // namespace

void put_results(const TieProblem& problem, const AdjustRounds& rounds, const core::SensorSigma& noise, const AdjustOptions& options,
                 const HeldEffects& held, Adjustment& out) {
  put_counts(problem, rounds, out);
  put_components(problem, rounds, noise, options.components.surface_sigma.value, out);
  put_corrections(problem, rounds, held, out);
  put_planes(rounds, out);
  put_groups(problem, rounds, out);
  put_control(rounds, out);
  put_samples(problem, rounds, out);
}

}  // namespace swath::calib
