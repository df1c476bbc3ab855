// SPDX-License-Identifier: GPL-3.0-or-later
// Over 400 lines: the steps of one adjustment, in their order, on one state.
// Sources: Skaloud & Lichti (2006) and Glira et al. (2016) for the model (calib/adjust/tie_normals.h, correction_knots.h); Foerstner (1979)
// for the variances; Baarda (1968) for the tests; Schmidt (1966) for values that are held and yet uncertain ("considered"). Here: the
// unknowns are chosen, the rounds are run, and the results are put together. Deviations: sigmas take the estimated variances as known
// (their own scatter adds a per cent or so to 20 degrees of freedom's 16 % in a component that is one of several); refused values are
// delivered as they started while the others come from the joint solution.
#include "calib/adjust/adjust.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "calib/adjust/adjust_rounds.h"
#include "calib/adjust/diagnosis.h"
#include "calib/adjust/held_effects.h"
#include "calib/adjust/jackknife.h"
#include "calib/adjust/parameter_words.h"
#include "calib/adjust/short_waves.h"
#include "calib/adjust/start_sigmas.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr size_t most_samples = 20000;
constexpr double common_shift = 1.0;      // m: how wrong all positions may be together, for Separation::unaided
constexpr int least_jackknifed = 4;       // lines: without one of two or three the others' geometry is another flight's
constexpr double factor_to_tell = 2.0;    // of a stated sigma
constexpr double hardly_apart = 0.9;      // correlation
constexpr double planes_apart = 10.0;     // of the ranges' sigma: lines that disagree so much were not put together rightly
constexpr double outside_to_tell = 0.01;  // share of returns

std::vector<Parameter> chosen(const EstimateOptions& o, const core::Scanner& scanner, std::vector<Finding>& findings) {
  const BeamModel beam(scanner);
  const bool wanted[] = {o.roll,         o.pitch,       o.heading,     o.lever_forward, o.lever_right, o.lever_down,
                         o.range_offset, o.range_scale, o.scan_offset, o.scan_scale,    o.latency};
  std::vector<Parameter> out;
  for (int k = boresight_roll; k <= latency; ++k) {
    const auto p = static_cast<Parameter>(k);
    if (!wanted[k]) continue;
    if (p == scan_offset && o.roll && beam.is_across()) {
      findings.push_back({"scan offset and boresight roll are the same turn of a scanner that scans across: the scan offset is held",
                          "estimate one of the two",
                          {scan_offset},
                          true});
      continue;
    }
    if (p == scan_offset && o.heading && scanner.model == core::ScannerModel::conical) {
      findings.push_back(
          {"scan offset and boresight heading are the same turn of a scanner whose beam goes around the nadir: the scan offset is held",
           "estimate one of the two",
           {scan_offset},
           true});
      continue;
    }
    if (p == scan_scale && beam.ignores_record()) continue;
    out.push_back(p);
  }
  return out;
}

std::string metres(double v) {
  std::ostringstream s;
  s.setf(std::ios::fixed);
  s.precision(std::abs(v) < 10.0 ? 3 : 2);
  s << v << " m";
  return s.str();
}
std::string number(double v) {
  std::ostringstream s;
  s.precision(2);
  s << v;
  return s.str();
}

// The globals' information, corrections eliminated.
MatrixXd eliminated(const MatrixXd& N, Eigen::Index globals) {
  const Eigen::Index knots = N.rows() - globals;
  MatrixXd out = N.topLeftCorner(globals, globals);
  if (knots == 0) return out;
  const MatrixXd K = N.bottomRightCorner(knots, knots);
  const VectorXd scale = K.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> llt(scale.asDiagonal() * K * scale.asDiagonal());
  const MatrixXd cross = scale.asDiagonal() * N.bottomLeftCorner(knots, globals);
  out -= cross.transpose() * llt.solve(cross);
  return 0.5 * (out + out.transpose());
}

VectorXd sigmas_with(const MatrixXd& information, const VectorXd& prior) {
  MatrixXd N = information;
  N.diagonal() += prior;
  const VectorXd scale = N.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const MatrixXd inverse = (scale.asDiagonal() * N * scale.asDiagonal()).llt().solve(MatrixXd::Identity(N.rows(), N.cols()));
  return scale.cwiseProduct(inverse.diagonal().cwiseMax(0.0).cwiseSqrt());
}

class Results {
 public:
  Results(const TieProblem& problem, const AdjustRounds& rounds, const core::Calibration& start, const core::SensorSigma& noise,
          const VectorXd& apriori, const AdjustOptions& options, Adjustment& out)
      : p_(problem),
        r_(rounds),
        start_(start),
        noise_(noise),
        apriori_(apriori),
        o_(options),
        out_(out),
        globals_(static_cast<Eigen::Index>(problem.globals.size())) {}

  void all() {
    counts();
    components();
    held_ = effects_of_held(p_, r_, noise_);
    corrections();
    planes();
    residuals();
    separate();
    estimates();
    look();
  }

 private:
  void counts() {
    out_.iterations = r_.rounds;
    out_.converged = r_.converged;
    for (Eigen::Index i = 0; i < globals_; ++i)
      out_.last_step = std::max(out_.last_step, std::abs(r_.solution.x[i]) / std::sqrt(std::max(1e-300, r_.solution.covariance(i, i))));
    double sum = 0.0, freedom = 0.0;
    for (size_t g = 0; g < r_.pass.blocks.size(); ++g) {
      const GroupBlock& b = r_.pass.blocks[g];
      out_.rejected_returns += b.rejected;
      outside_ += b.outside;
      if (!r_.use.group[g]) {
        out_.rejected_returns += b.used;
        continue;
      }
      out_.observations += b.used;
      sum += r_.system().block(g).c / p_.robust.consistency();
    }
    freedom = static_cast<double>(out_.observations);
    for (size_t c = 0; c < r_.use.control.size(); ++c) {
      if (!r_.use.control[c]) continue;
      ++out_.observations;
      freedom += 1.0;
      const ControlRow& row = r_.system().control()[c];
      sum += row.f * row.f / (row.sigma * row.sigma);
    }
    // The corrections' prior values are as many observations as there are corrections.
    if (r_.state.correction.size() > 0) sum += r_.state.correction.dot(r_.prior.corrections * r_.state.correction);
    out_.unknowns = static_cast<std::uint64_t>(p_.size()) + 3 * r_.state.planes.size();
    freedom -= static_cast<double>(globals_) + 3.0 * static_cast<double>(r_.state.planes.size());
    out_.sigma0 = freedom > 0.0 ? std::sqrt(sum / freedom) : not_known;
  }

  void components() {
    const SigmaFactors& f = r_.factors;
    double squares[2] = {}, count[2] = {}, control = 0.0;
    const CorrectionKnots& knots = *p_.knots;
    for (int i = 0; i < knots.size(); ++i) {
      const int part = knots.is_position(i) ? 0 : 1;
      squares[part] += knots.covariance()(i, i);
      count[part] += 1.0;
    }
    const auto rms = [](double sum, double n) { return n > 0.0 ? std::sqrt(std::max(0.0, sum) / n) : 0.0; };
    const std::vector<ControlRow> rows = control_rows(r_.state.planes, 1.0);
    for (const ControlRow& row : rows) control += row.sigma * row.sigma;
    const auto add = [&](const std::string& name, double stated, const SigmaFactor& s) {
      out_.components.push_back({name, stated, s.factor, s.redundancy, s.estimated});
    };
    add("range", noise_.range.value, f.range);
    add("angle", std::hypot(noise_.scan_angle.value, noise_.beam_divergence.value / 4.0), f.angle);
    add("surface", o_.components.surface_sigma.value, f.surface);
    for (const int part : {0, 1}) {
      if (count[part] == 0.0) continue;
      const std::array<SigmaFactor, 3>& of = part == 0 ? f.position : f.attitude;
      const std::string name = part == 0 ? "trajectory position" : "trajectory attitude";
      if (!knots.scales_apart()) {
        add(name, rms(squares[part], count[part]), of[0]);
        continue;
      }
      const auto share = [&](CorrectionScale scale) {
        const MatrixXd& m = knots.modes(part == 0, scale);
        return (m.transpose() * knots.covariance() * m).trace();
      };
      const double mean = share(line_mean), drift = share(line_drift);
      add(name + ", mean of a line", rms(mean, count[part]), of[line_mean]);
      add(name + ", drift along a line", rms(drift, count[part]), of[line_drift]);
      add(name + ", within a line", rms(squares[part] - mean - drift, count[part]), of[within_line]);
    }
    if (!rows.empty()) add("control", rms(control, static_cast<double>(rows.size())), f.control);
  }

  void corrections() {
    const CorrectionKnots& k = *p_.knots;
    const TieSet& ties = *p_.ties;
    const MatrixXd apriori = k.covariance(r_.factors.of_position(), r_.factors.of_attitude());
    MatrixXd with_held = r_.solution.covariance;
    with_held.bottomRightCorner(k.size(), k.size()) += held_.covariance(globals_, k.size());
    for (size_t l = 0; l < ties.lines.size(); ++l) {
      LineCorrection c;
      c.line = ties.lines[l].id;
      for (const double t : k.size() > 0 ? k.times(l) : std::vector<double>{}) {
        std::vector<int> numbers;
        const MatrixXd D = k.derivatives(l, t, numbers);
        const auto variances = [&](const MatrixXd& of, Eigen::Index offset) {
          std::array<double, 6> s{};
          MatrixXd C(D.cols(), D.cols());
          for (Eigen::Index i = 0; i < D.cols(); ++i)
            for (Eigen::Index j = 0; j < D.cols(); ++j) C(i, j) = of(offset + numbers[i], offset + numbers[j]);
          const MatrixXd V = D * C * D.transpose();
          for (int i = 0; i < 6; ++i) s[i] = std::sqrt(std::max(0.0, V(i, i)));
          return s;
        };
        const Correction v = k.at(l, t, r_.state.correction);
        c.time.push_back(t);
        c.value.push_back({v[0], v[1], v[2], v[3], v[4], v[5]});
        c.sigma.push_back(variances(with_held, globals_));
        c.apriori.push_back(variances(apriori, 0));
        c.response.push_back(Eigen::Matrix<double, 6, latency + 1>::Zero());
        for (size_t h = 0; h < held_.parameters.size(); ++h)
          for (Eigen::Index i = 0; i < D.cols(); ++i)
            c.response.back().col(held_.parameters[h]) +=
                D.col(i) * (held_.effect(globals_ + numbers[static_cast<size_t>(i)], static_cast<Eigen::Index>(h)) /
                            held_.sigma[static_cast<Eigen::Index>(h)]);
      }
      out_.corrections.push_back(std::move(c));
    }
  }

  void planes() {
    out_.planes = r_.state.planes;
    for (const PlaneRest& rest : r_.rests)
      out_.plane_sigma.push_back(plane_covariance(rest, r_.solution.covariance).diagonal().cwiseSqrt());
  }

  void residuals() {
    const TieSet& ties = *p_.ties;
    size_t returns = 0;
    for (size_t g = 0; g < ties.groups.size(); ++g) {
      const GroupBlock& b = r_.pass.blocks[g];
      GroupResidual r;
      r.plane = ties.groups[g].plane;
      r.line = ties.groups[g].line;
      r.returns = b.used;
      r.time = b.time;
      r.angle = b.angle;
      r.range = b.range;
      r.before = r_.before[g];
      if (b.used > 0) {
        r.after = -b.b[static_cast<Eigen::Index>(b.index.size())] / b.weight();
        r.rms = std::sqrt(b.c / b.weight());
      }
      r.redundancy = r_.tests.group[g].redundancy;
      r.w = r_.tests.group[g].w;
      r.rejected = !r_.use.group[g];
      out_.groups.push_back(r);
      if (r_.use.group[g]) returns += ties.groups[g].end - ties.groups[g].begin;
    }
    if (p_.knots->size() > 0 && p_.knots->spacing() > 0.0) out_.waves_between = short_waves(out_.groups, 0.5 * p_.knots->spacing()).seen();
    size_t c = 0;
    for (size_t k = 0; k < r_.state.planes.size(); ++k)
      for (const PlaneControl& control : r_.state.planes[k].control) {
        const ControlRow& row = r_.system().control()[c];
        out_.control.push_back({control.name, static_cast<std::uint32_t>(k), row.f, row.sigma, r_.tests.control[c].redundancy,
                                r_.tests.control[c].w, !r_.use.control[c]});
        ++c;
      }
    const size_t step = std::max<size_t>(1, (returns + most_samples - 1) / most_samples);
    const ShotGeometry geometry(*p_.scanner, r_.state.calibration);
    const TieNoise noise = r_.noise();
    trajectory::Cursor cursor(*p_.trajectory);
    size_t next = 0;
    for (size_t g = 0; g < ties.groups.size(); ++g) {
      if (!r_.use.group[g]) continue;
      for (size_t i = ties.groups[g].begin; i < ties.groups[g].end; ++i, ++next) {
        Condition at;
        if (next % step != 0 || !condition_of(p_, geometry, r_.state, noise, cursor, ties.groups[g], i, at)) continue;
        out_.samples.push_back({static_cast<std::uint32_t>(g), geometry.time(ties.returns.time[i]), geometry.angle(ties.returns.angle[i]),
                                geometry.range(ties.returns.range[i]), at.f, std::sqrt(at.variance())});
      }
    }
  }

  // What the data alone show of the global unknowns, and what they would show if all positions could be shifted together.
  void separate() {
    sep_.information = eliminated(r_.data.N, globals_);
    sep_.formal = r_.solution.covariance.diagonal().head(globals_).cwiseSqrt();
    const MatrixXd B = p_.knots->common_shift();
    if (globals_ == 0 || B.size() == 0 || B.isZero()) return;
    const MatrixXd& Q = r_.prior.corrections;
    const MatrixXd QB = Q * B;
    const MatrixXd inner = B.transpose() * QB + MatrixXd::Identity(3, 3) / (common_shift * common_shift);
    MatrixXd N = r_.data.N;
    N.bottomRightCorner(Q.rows(), Q.cols()) -= QB * inner.ldlt().solve(QB.transpose());
    sep_.unaided = sigmas_with(eliminated(N, globals_), r_.prior.globals);
  }

  VectorXd white() const {
    if (globals_ == 0) return {};
    Normals n{MatrixXd::Zero(globals_, globals_), VectorXd::Zero(globals_)};
    for (std::uint32_t k = 0; k < r_.system().planes(); ++k) r_.system().add(k, r_.use, 1.0, n, true);
    return sigmas_with(n.N, r_.prior.globals);
  }

  void estimates() {
    const VectorXd white_sigma = white();
    const MatrixXd held = held_.covariance(0, globals_);
    const double significance = o_.jackknife.significance;
    Jackknife lines, regions;
    if (globals_ > 0 && o_.jackknife.lines)
      lines = jackknife(p_, r_.system(), r_.use, r_.normals, r_.solution, groups_by_line(*p_.ties, r_.use));
    if (globals_ > 0 && o_.jackknife.blocks > 1)
      regions = jackknife(p_, r_.system(), r_.use, r_.normals, r_.solution, groups_by_region(*p_.ties, r_.use, o_.jackknife.blocks));
    for (Eigen::Index i = 0; i < globals_; ++i) {
      Estimate& e = out_.estimates[p_.globals[i]];
      e.estimated = true;
      e.found = value_of(r_.state.calibration, e.parameter);
      e.apriori = apriori_[i];
      e.formal = sep_.formal[i];
      e.white = white_sigma[i];
      double larger = 1.0;
      if (lines.replicates > 0) {
        e.jackknife_lines = lines.sigma[i];
        if (lines.replicates >= least_jackknifed) larger = std::max(larger, enlargement(lines.ratio[i], lines.freedom[i], significance));
      }
      if (regions.replicates > 0) {
        e.jackknife_planes = regions.sigma[i];
        larger = std::max(larger, enlargement(regions.ratio[i], regions.freedom[i], significance));
      }
      e.held = std::sqrt(std::max(0.0, held(i, i)));
      const double told = lines.replicates >= least_jackknifed ? std::max(larger * e.formal, e.jackknife_lines) : larger * e.formal;
      e.sigma = e.found_sigma = std::hypot(told, e.held);
      e.determined = std::isfinite(e.apriori) ? 1.0 - std::pow(e.formal / e.apriori, 2) : 1.0;
    }
    const MatrixXd C = r_.solution.covariance.topLeftCorner(globals_, globals_) + held;
    const VectorXd inverse = C.diagonal().cwiseSqrt().cwiseInverse();
    out_.correlation = inverse.asDiagonal() * C * inverse.asDiagonal();
    out_.correlation.diagonal().setOnes();
    out_.condition = scaled_condition(sep_.information);
    keep_covariance();

    // The limits are held against the sigma that would be delivered.
    Separation judged = sep_;
    for (Eigen::Index i = 0; i < globals_; ++i) judged.formal[i] = out_.estimates[p_.globals[i]].sigma;
    FlightShape shape = shape_of(p_, r_.state, r_.pass.blocks);
    shape.control = std::find(r_.use.control.begin(), r_.use.control.end(), char{1}) != r_.use.control.end();
    std::vector<Parameter> refused;
    for (Finding& f : diagnose(p_.globals, judged, apriori_, shape, o_.limits)) {
      if (f.refuses) refused.insert(refused.end(), f.parameters.begin(), f.parameters.end());
      out_.findings.push_back(std::move(f));
    }
    tell_correlated(refused, shape);
  }

  void keep_covariance() {
    constexpr int n = latency + 1;
    out_.formal = out_.held = MatrixXd::Zero(n, n);
    out_.held_correlation = MatrixXd::Identity(n, n);
    for (Eigen::Index i = 0; i < globals_; ++i)
      for (Eigen::Index j = 0; j < globals_; ++j) out_.formal(p_.globals[i], p_.globals[j]) = r_.solution.covariance(i, j);
    for (size_t h = 0; h < held_.parameters.size(); ++h) {
      const auto column = static_cast<Eigen::Index>(h);
      const Parameter p = held_.parameters[h];
      out_.held(p, p) = held_.sigma[column];
      for (Eigen::Index i = 0; i < globals_; ++i) out_.held(p_.globals[i], p) = held_.effect(i, column);
      for (size_t k = 0; k < held_.parameters.size(); ++k)
        out_.held_correlation(p, held_.parameters[k]) = held_.correlation(column, static_cast<Eigen::Index>(k));
    }
  }

  void tell_correlated(const std::vector<Parameter>& refused, const FlightShape& shape) {
    const auto is_refused = [&](Parameter p) { return std::find(refused.begin(), refused.end(), p) != refused.end(); };
    for (Eigen::Index i = 0; i < globals_; ++i)
      for (Eigen::Index j = 0; j < i; ++j) {
        const Parameter a = p_.globals[j], b = p_.globals[i];
        if (is_refused(a) || is_refused(b) || !(std::abs(out_.correlation(i, j)) > hardly_apart)) continue;
        out_.findings.push_back({std::string(words_of(a).name) + " and " + std::string(words_of(b).name) +
                                     " are hardly told apart: an error of the one is balanced by the other (correlations)",
                                 !shape.crossed       ? "fly lines across"
                                 : !shape.two_heights ? "fly some lines at another height, lower or higher by half"
                                                      : "survey a target on the ground",
                                 {a, b},
                                 false});
      }
  }

  void look() {
    const auto tell = [this](std::string what, std::string cure, bool refuses = false) {
      out_.findings.push_back({std::move(what), std::move(cure), refuses ? p_.globals : std::vector<Parameter>{}, refuses});
    };
    if (r_.shift.shifted) {
      const char* names[] = {"east", "north", "up"};
      std::string where;
      for (int k = 0; k < 3; ++k)
        where += std::string(k ? ", " : "") + names[k] + " " + (r_.shift.known[k] ? metres(r_.shift.mean[k]) : std::string("not told"));
      tell("control does not fit: mean misfit " + where + ": another datum? It was left out",
           "state the control's CRS and kind of heights (ellipsoidal or with a geoid) as they are");
    }
    if (r_.surface() > planes_apart * r_.noise().range)
      tell("the planes of different lines do not agree: " + metres(r_.surface()) + " apart after the adjustment",
           "check the sign of the scan angle, the line numbers, the time scale and the trajectory", true);
    const SigmaFactors& f = r_.factors;
    const auto worse = [&](const SigmaFactor& s, const char* what, const char* cure) {
      if (s.estimated && s.factor > factor_to_tell)
        tell(std::string(what) + " err " + number(s.factor) + " times as much as stated; the sigmas hold that", cure);
    };
    worse(f.range, "ranges", "state the sigma of the ranges as it is");
    worse(f.angle, "scan angles", "state the sigma of the scan angles and the beam's divergence as they are");
    worse(f.position[line_mean], "the trajectory's positions", "look at its GNSS and its report; state stated_position instead");
    worse(f.attitude[line_mean], "the trajectory's attitudes", "look at its IMU's model and its report");
    worse(f.control, "control points", "look at their residuals");
    if (out_.waves_between)
      tell("what is left on the planes waves along the lines: the trajectory errs faster than corrections " + number(out_.knot_spacing) +
               " s apart can follow; sigmas of the corrections may be too small",
           "narrow corrections.spacing, raise corrections.most");
    if (r_.snooping_full)
      tell("more planes or control points are displaced than may be left out",
           "look at the groups with the largest w; raise snooping.share");
    if (static_cast<double>(outside_) > outside_to_tell * static_cast<double>(p_.ties->returns.size()))
      tell(std::to_string(outside_) + " of " + std::to_string(p_.ties->returns.size()) + " returns lie at times without trajectory",
           "check time scales and gaps");
    if (out_.last_step > settled_step)
      tell("the adjustment did not converge: its last step still moves a value by " + number(out_.last_step) + " of its sigmas",
           "start from better values, or allow more iterations", true);
    else if (!r_.converged)
      tell("the adjustment is not steady after " + std::to_string(r_.rounds) + " rounds of linearisation", "allow more iterations");
  }

  const TieProblem& p_;
  const AdjustRounds& r_;
  const core::Calibration& start_;
  const core::SensorSigma& noise_;
  const VectorXd& apriori_;
  const AdjustOptions& o_;
  Adjustment& out_;
  Eigen::Index globals_;
  Separation sep_;
  HeldEffects held_;
  std::uint64_t outside_ = 0;
};

}  // namespace

namespace {

/// A start value that the flight contradicts counts for nothing.
void report_contradicted(const TieProblem& problem, const AdjustRounds& r, VectorXd& apriori, std::vector<Finding>& findings) {
  for (size_t i = 0; i < problem.globals.size(); ++i) {
    const double far = r.contradiction[static_cast<Eigen::Index>(i)];
    if (far == 0.0) continue;
    const Parameter p = problem.globals[i];
    findings.push_back({"the start value of " + std::string(words_of(p).name) + " is off by " + number(far) +
                            " times its stated sigma: it counts for nothing",
                        "state [sigma] of the survey as the value is known",
                        {p},
                        false});
    apriori[static_cast<Eigen::Index>(i)] = infinite;
  }
}

}  // namespace

Adjustment adjust(const TieSet& ties, const core::Scanner& scanner, const core::Calibration& start, const core::SensorSigma& noise,
                  const trajectory::Trajectory& trajectory, const ErrorCovariance& covariance, const AdjustOptions& options, int threads,
                  ErrorShape shape) {
  Adjustment out;
  out.calibration = start;
  for (int k = boresight_roll; k <= latency; ++k) {
    Estimate& e = out.estimates[k];
    e.parameter = static_cast<Parameter>(k);
    e.start = e.value = e.found = value_of(start, e.parameter);
  }
  const bool is_stated = options.corrections.prior == CorrectionPrior::stated;
  const CorrectionKnots knots(ties.lines, start.latency.value, options.corrections,
                              is_stated ? stated_covariance(options.corrections) : covariance, is_stated || shape == ErrorShape::guessed);
  out.knot_spacing = knots.spacing();
  TieProblem problem{&ties, &scanner, &trajectory, &knots, {}, RobustWeight(options.robust.full, options.robust.zero), threads};
  problem.globals = chosen(options.estimate, scanner, out.findings);
  VectorXd apriori(problem.globals.size()), limit(problem.globals.size());
  for (size_t i = 0; i < problem.globals.size(); ++i) {
    apriori[i] = apriori_of(options.apriori, problem.globals[i]);
    limit[i] = limit_of(options.limits, problem.globals[i]);
  }

  AdjustRounds rounds(problem, start, noise, apriori, limit, options);
  rounds.run();
  if (!rounds.solution.solved) {
    out.planes = ties.planes;
    out.findings.push_back(
        {"the normal equations cannot be solved", "check that trajectory and returns are of one flight", problem.globals, true});
    return out;
  }
  report_contradicted(problem, rounds, apriori, out.findings);
  Results(problem, rounds, start, noise, apriori, options, out).all();

  for (size_t i = 0; i < problem.globals.size(); ++i) {
    const Parameter p = problem.globals[i];
    Estimate& e = out.estimates[p];
    e.delivered = true;
    e.grade = e.sigma <= limit[static_cast<Eigen::Index>(i)] ? Grade::good : Grade::coarse;
    e.value = e.found;
    set_value(out.calibration, p, e.value);
  }
  for (const Finding& f : out.findings)
    if (f.refuses) withdraw(out, f.parameters, out.last_step > settled_step ? Grade::unsettled : Grade::undetermined);
  return out;
}

}  // namespace swath::calib
