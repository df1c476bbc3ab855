// SPDX-License-Identifier: GPL-3.0-or-later
// Source of shift and drift per line: Ackermann, GNSS-supported block adjustment, eq 1; of knots by time: Glira, Pfeifer & Mandlburger,
// "Rigorous strip adjustment of UAV-based laserscanning data including time-dependent correction of trajectory errors" (2016).
// Deviation: errors between knots that are not linear in time are not in this model. They are left to the sigma of the surfaces, which is
// estimated (calib/adjust/variance_components.h).
#include "calib/adjust/correction_knots.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace swath::calib {
namespace {

// A line shorter than this has one constant.
constexpr double shortest_line = 0.05;  // s
// Sigmas that no error falls below: exact trajectories state zeros, which cannot be inverted.
constexpr double least_position = 1e-6;  // m
constexpr double least_attitude = 1e-9;  // rad
// Independent part added to each unknown's variance so that nearly equal ones can be distinguished by the arithmetic: a thousandth of its
// sigma.
constexpr double own_share = 1e-6;
constexpr double narrower = 1.5;  // by which lines are chained

double least_variance(bool position) {
  const double least = position ? least_position : least_attitude;
  return least * least;
}

std::vector<double> grid_of(double first, double last, double spacing) {
  if (last - first < shortest_line) return {0.5 * (first + last)};
  const int steps = std::max(1, static_cast<int>(std::ceil((last - first) / spacing - 1e-9)));
  std::vector<double> out;
  for (int i = 0; i <= steps; ++i) out.push_back(first + (last - first) * i / steps);
  return out;
}

size_t unknowns_at(const std::vector<TieLine>& lines, int splines, double spacing) {
  size_t n = 0;
  for (const TieLine& l : lines) n += 3 * static_cast<size_t>(splines) * grid_of(l.first, l.last, spacing).size();
  return n;
}

// The stated spacing, or the least wider one that keeps the number of unknowns.
double spacing_for(const std::vector<TieLine>& lines, int splines, double stated, size_t most) {
  double spacing = stated;
  // Two knots on each line are the least.
  most = std::max<size_t>(most, 6 * static_cast<size_t>(splines) * lines.size());
  while (unknowns_at(lines, splines, spacing) > most) spacing *= 1.1;
  return spacing;
}

// Rows: knots of the form; columns: instants of the grid. The least-squares fit of the form to values on the grid.
Eigen::MatrixXd projection(CorrectionForm form, const std::vector<double>& grid) {
  const auto n = static_cast<Eigen::Index>(grid.size());
  if (form == CorrectionForm::none) return Eigen::MatrixXd(0, n);
  if (n == 1 || form == CorrectionForm::spline) return Eigen::MatrixXd::Identity(n, n);
  if (form == CorrectionForm::shift) return Eigen::MatrixXd::Constant(1, n, 1.0 / static_cast<double>(n));
  Eigen::MatrixXd A(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double share = (grid[static_cast<size_t>(i)] - grid.front()) / (grid.back() - grid.front());
    A.row(i) << 1.0 - share, share;
  }
  return (A.transpose() * A).ldlt().solve(A.transpose());
}

std::vector<double> knots_of(CorrectionForm form, const std::vector<double>& grid) {
  if (form == CorrectionForm::none) return {};
  if (form == CorrectionForm::shift && grid.size() > 1) return {0.5 * (grid.front() + grid.back())};
  if (form == CorrectionForm::drift && grid.size() > 1) return {grid.front(), grid.back()};
  return grid;
}

// The inverse of a covariance, scaled to correlations; what cannot be distinguished is given a small part of its own.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& covariance) {
  if (covariance.rows() == 0) return covariance;
  const Eigen::VectorXd sigma = covariance.diagonal().cwiseSqrt();
  const Eigen::MatrixXd correlation = sigma.cwiseInverse().asDiagonal() * covariance * sigma.cwiseInverse().asDiagonal();
  for (double own = own_share;; own *= 10.0) {
    Eigen::MatrixXd C = correlation;
    C.diagonal().array() += own;
    const Eigen::LLT<Eigen::MatrixXd> llt(C);
    if (llt.info() != Eigen::Success && own < 1.0) continue;
    const Eigen::MatrixXd inverse = llt.solve(Eigen::MatrixXd::Identity(C.rows(), C.cols()));
    return sigma.cwiseInverse().asDiagonal() * inverse * sigma.cwiseInverse().asDiagonal();
  }
}

/// Correlation of the lines' means and drifts, by their errors at a quarter and three quarters of each: identity blocks on the diagonal.
Eigen::MatrixXd correlation_of_trends(const Eigen::MatrixXd& errors, Eigen::Index q) {
  const Eigen::Index n = errors.rows() / (2 * q);
  Eigen::MatrixXd T(2 * q, 2 * q), back = Eigen::MatrixXd::Zero(errors.rows(), errors.cols());
  T << 0.5 * Eigen::MatrixXd::Identity(q, q), 0.5 * Eigen::MatrixXd::Identity(q, q), -Eigen::MatrixXd::Identity(q, q),
      Eigen::MatrixXd::Identity(q, q);
  for (Eigen::Index l = 0; l < n; ++l) {
    const Eigen::MatrixXd own = T * errors.block(2 * q * l, 2 * q * l, 2 * q, 2 * q) * T.transpose();
    back.block(2 * q * l, 2 * q * l, 2 * q, 2 * q) = root_of(own).inverse() * T;
  }
  Eigen::MatrixXd out = back * errors * back.transpose();
  // A combination that a line's errors do not have was given a share of its own.
  for (Eigen::Index l = 0; l < n; ++l) out.block(2 * q * l, 2 * q * l, 2 * q, 2 * q).setIdentity();
  return out;
}

}  // namespace

ErrorCovariance stated_covariance(const CorrectionOptions& o) {
  const double p = o.stated_position.value, a = o.stated_roll_pitch.value, h = o.stated_heading.value;
  const Correction sigma = (Correction() << p, p, p, a, a, h).finished();
  return [sigma, tau = o.stated_correlation.value](const std::vector<double>& t) {
    const auto n = static_cast<Eigen::Index>(t.size());
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(6 * n, 6 * n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j)
        C.block<6, 6>(6 * i, 6 * j) = std::exp(-std::abs(t[i] - t[j]) / tau) * Eigen::MatrixXd(sigma.cwiseAbs2().asDiagonal());
    return C;
  };
}

CorrectionKnots::CorrectionKnots(const std::vector<TieLine>& lines, double latency, const CorrectionOptions& o,
                                 const ErrorCovariance& given, bool scales_apart)
    : scales_apart_(scales_apart) {
  const int splines = (o.position == CorrectionForm::spline) + (o.attitude == CorrectionForm::spline);
  const auto is = [&](CorrectionForm form) { return o.position == form || o.attitude == form; };
  const double together = spacing_for(lines, splines, o.spacing.value, static_cast<size_t>(std::min(o.most, max_together)));
  const double apart = spacing_for(lines, splines, o.spacing.value, static_cast<size_t>(o.most));
  const bool chained = splines > 0 && !is(CorrectionForm::shift) && !is(CorrectionForm::drift) && o.most > max_together &&
                       unknowns_at(lines, splines, o.spacing.value) > max_together &&
                       (apart == o.spacing.value || narrower * apart < together);
  spacing_ = chained ? apart : together;
  place_lines(lines, latency, o);
  if (chained) {
    make_chains(given);
    return;
  }
  make_modes();
  make_dense(o, given);
}

void CorrectionKnots::place_lines(const std::vector<TieLine>& lines, double latency, const CorrectionOptions& o) {
  const auto place = [this](Knots& k, CorrectionForm form, const std::vector<double>& grid, bool position) {
    k.time = knots_of(form, grid);
    k.first = size_;
    size_ += 3 * static_cast<int>(k.time.size());
    is_position_.resize(static_cast<size_t>(size_), position);
  };
  for (const TieLine& l : lines) {
    Line line;
    line.grid = grid_of(l.first + latency, l.last + latency, spacing_);
    place(line.position, o.position, line.grid, true);
    place(line.attitude, o.attitude, line.grid, false);
    line.given = std::max(line.position.time.size(), line.attitude.time.size()) > 1
                     ? (line.position.time.size() > line.attitude.time.size() ? line.position.time : line.attitude.time)
                     : std::vector<double>{line.grid.front(), line.grid.back()};
    lines_.push_back(std::move(line));
  }
}

void CorrectionKnots::make_dense(const CorrectionOptions& o, const ErrorCovariance& given) {
  covariance_ = Eigen::MatrixXd::Zero(size_, size_);
  if (size_ == 0) {
    information_ = covariance_;
    return;
  }
  std::vector<double> instants;
  std::vector<Eigen::Index> first_instant;
  for (const Line& l : lines_) {
    first_instant.push_back(static_cast<Eigen::Index>(instants.size()));
    instants.insert(instants.end(), l.grid.begin(), l.grid.end());
  }
  const Eigen::MatrixXd errors = given(instants);
  // The unknowns are P times the errors at the instants.
  std::vector<Eigen::Triplet<double>> entries;
  for (size_t l = 0; l < lines_.size(); ++l)
    for (const int part : {0, 1}) {
      const Knots& knots = part == 0 ? lines_[l].position : lines_[l].attitude;
      const Eigen::MatrixXd share = projection(part == 0 ? o.position : o.attitude, lines_[l].grid);
      for (Eigen::Index k = 0; k < share.rows(); ++k)
        for (Eigen::Index i = 0; i < share.cols(); ++i)
          for (int c = 0; c < 3 && share(k, i) != 0.0; ++c)
            entries.emplace_back(knots.first + 3 * k + c, 6 * (first_instant[l] + i) + 3 * part + c, share(k, i));
    }
  Eigen::SparseMatrix<double> P(size_, errors.rows());
  P.setFromTriplets(entries.begin(), entries.end());
  covariance_ = P * (P * errors).transpose();
  for (int i = 0; i < size_; ++i) covariance_(i, i) += least_variance(is_position(i));
  information_ = inverse_of(covariance_);
}

ChainPlaces CorrectionKnots::chain_places(const Line& line, bool trend) {
  ChainPlaces out;
  const size_t l = static_cast<size_t>(&line - lines_.data());
  for (size_t k = 0; k < line.grid.size(); ++k) {
    std::vector<int> numbers;
    for (const Knots* part : {&line.position, &line.attitude})
      for (int c = 0; c < 3 && !part->time.empty(); ++c) {
        numbers.push_back(part->first + 3 * static_cast<int>(k) + c);
        knot_of_[static_cast<size_t>(numbers.back())] = {l, k, numbers.size() - 1};
      }
    out.knot.push_back(std::move(numbers));
  }
  for (size_t i = 0; trend && i < 2 * out.knot.front().size(); ++i) out.trend.push_back(size_ + trends_++);
  return out;
}

void CorrectionKnots::make_chains(const ErrorCovariance& given) {
  std::vector<bool> is_position;
  std::vector<Eigen::Index> rows;  // of the errors' six
  for (int c = 0; c < 6; ++c)
    if (!(c < 3 ? lines_.front().position : lines_.front().attitude).time.empty()) {
      rows.push_back(c);
      is_position.push_back(c < 3);
    }
  const auto q = static_cast<Eigen::Index>(rows.size());
  const auto some = [&](const std::vector<double>& times) {
    std::vector<Eigen::Index> wanted;
    for (size_t k = 0; k < times.size(); ++k)
      for (const Eigen::Index r : rows) wanted.push_back(6 * static_cast<Eigen::Index>(k) + r);
    Eigen::MatrixXd C = given(times)(wanted, wanted);
    for (Eigen::Index i = 0; i < C.rows(); ++i) C(i, i) += least_variance(is_position[static_cast<size_t>(i % q)]);
    return C;
  };
  std::vector<LineChain> chains;
  std::vector<ChainPlaces> places;
  std::vector<double> quarters;
  knot_of_.resize(static_cast<size_t>(size_));
  for (const Line& l : lines_) {
    chains.push_back(chain_of(line_covariance(l.grid, q, some)));
    places.push_back(chain_places(l, !chains.back().place.empty()));
    if (places.back().trend.empty()) continue;
    const double length = l.grid.back() - l.grid.front();
    quarters.insert(quarters.end(), {l.grid.front() + 0.25 * length, l.grid.front() + 0.75 * length});
  }
  const Eigen::MatrixXd trends = quarters.empty() ? Eigen::MatrixXd(0, 0) : correlation_of_trends(some(quarters), q);
  chains_.emplace(std::move(chains), std::move(places), trends, is_position);
}

std::vector<int> CorrectionKnots::nodes(int globals) const {
  std::vector<int> out(static_cast<size_t>(globals + size()), 0);
  if (!chains_) return out;
  int next = globals > 0 ? 1 : 0;
  const auto at = [&](int u) -> int& { return out[static_cast<size_t>(globals + u)]; };
  std::vector<int> first;  // node of each line's first knot
  for (const Line& l : lines_) {
    first.push_back(next);
    next += static_cast<int>(l.grid.size());
  }
  for (int u = 0; u < size_; ++u)
    at(u) = first[knot_of_[static_cast<size_t>(u)].line] + static_cast<int>(knot_of_[static_cast<size_t>(u)].knot);
  const int components = static_cast<int>(chains_->components());
  for (int t = 0; t < trends_; ++t) at(size_ + t) = next + t / (2 * components);
  return out;
}

CorrectionKnots::Weights CorrectionKnots::weights(const Knots& k, double t) {
  Weights w;
  if (k.time.empty()) return w;
  if (k.time.size() == 1) return {1, {k.first, 0}, {1.0, 0.0}};
  const double step = (k.time.back() - k.time.front()) / static_cast<double>(k.time.size() - 1);
  const double place = (std::clamp(t, k.time.front(), k.time.back()) - k.time.front()) / step;
  const int j = std::min(static_cast<int>(place), static_cast<int>(k.time.size()) - 2);
  const double share = place - j;
  return {2, {k.first + 3 * j, k.first + 3 * j + 3}, {1.0 - share, share}};
}

Correction CorrectionKnots::at(size_t line, double t, const Eigen::VectorXd& x) const {
  Correction out = Correction::Zero();
  const Weights p = position(line, t), a = attitude(line, t);
  for (size_t i = 0; i < static_cast<size_t>(p.count); ++i) out.head<3>() += p.weight[i] * x.segment<3>(p.first[i]);
  for (size_t i = 0; i < static_cast<size_t>(a.count); ++i) out.tail<3>() += a.weight[i] * x.segment<3>(a.first[i]);
  return out;
}

Eigen::MatrixXd CorrectionKnots::derivatives(size_t line, double t, std::vector<int>& numbers) const {
  numbers.clear();
  const Weights w[2] = {position(line, t), attitude(line, t)};
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(6, 3 * (w[0].count + w[1].count));
  for (int part = 0; part < 2; ++part)
    for (size_t i = 0; i < static_cast<size_t>(w[part].count); ++i)
      for (int c = 0; c < 3; ++c) {
        D(3 * part + c, static_cast<Eigen::Index>(numbers.size())) = w[part].weight[i];
        numbers.push_back(w[part].first[i] + c);
      }
  return D;
}

void CorrectionKnots::make_modes() {
  for (const int part : {0, 1})
    for (const int scale : {line_mean, line_drift}) {
      std::vector<Eigen::VectorXd> columns;
      for (const Line& l : lines_) {
        const Knots& k = part == 0 ? l.position : l.attitude;
        const size_t n = k.time.size();
        if (n < (scale == line_mean ? 1u : 2u)) continue;
        const double middle = 0.5 * (k.time.front() + k.time.back());  // knots are evenly spaced
        for (int c = 0; c < 3; ++c) {
          Eigen::VectorXd v = Eigen::VectorXd::Zero(size_);
          for (size_t i = 0; i < n; ++i) v[k.first + 3 * static_cast<int>(i) + c] = scale == line_mean ? 1.0 : k.time[i] - middle;
          columns.push_back(v.normalized());
        }
      }
      Eigen::MatrixXd& m = modes_[static_cast<size_t>(part)][static_cast<size_t>(scale)];
      m.resize(size_, static_cast<Eigen::Index>(columns.size()));
      for (size_t i = 0; i < columns.size(); ++i) m.col(static_cast<Eigen::Index>(i)) = columns[i];
    }
}

// F = D + M E M^T: D is the factor within the line, M the means and drifts, E what their factors are more.
Eigen::MatrixXd CorrectionKnots::scaled(const Eigen::MatrixXd& A, const std::array<ScaleFactors, 2>& factor) const {
  Eigen::VectorXd D(size_);
  for (int i = 0; i < size_; ++i) D[i] = factor[is_position(i) ? 0 : 1][within_line];
  Eigen::MatrixXd out = D.asDiagonal() * A * D.asDiagonal();
  Eigen::Index n = 0;
  for (const auto& part : modes_)
    for (const Eigen::MatrixXd& m : part) n += m.cols();
  Eigen::MatrixXd M(size_, n);
  Eigen::VectorXd E(n);
  n = 0;
  for (const size_t part : {0, 1})
    for (const size_t scale : {line_mean, line_drift}) {
      const Eigen::MatrixXd& m = modes_[part][scale];
      M.middleCols(n, m.cols()) = m;
      E.segment(n, m.cols()).setConstant(factor[part][scale] - factor[part][within_line]);
      n += m.cols();
    }
  if (n == 0 || E.isZero(0.0)) return out;
  const Eigen::MatrixXd AM = A * M, ME = M * E.asDiagonal();
  const Eigen::MatrixXd side = D.asDiagonal() * AM * ME.transpose();
  out += side + side.transpose() + ME * (M.transpose() * AM) * ME.transpose();
  return 0.5 * (out + out.transpose());
}

Eigen::MatrixXd CorrectionKnots::covariance(const ScaleFactors& position, const ScaleFactors& attitude) const {
  return scaled(covariance_, {position, attitude});
}
Eigen::MatrixXd CorrectionKnots::information(const ScaleFactors& position, const ScaleFactors& attitude) const {
  const auto inverse = [](const ScaleFactors& f) { return ScaleFactors{1.0 / f[0], 1.0 / f[1], 1.0 / f[2]}; };
  return scaled(information_, {inverse(position), inverse(attitude)});
}

void CorrectionKnots::add_information(const ScaleFactors& position, const ScaleFactors& attitude, int first, TieMatrix& into) const {
  if (chains_) return chains_->add_information({position, attitude}, first, into);
  std::vector<int> all(static_cast<size_t>(size_));
  std::iota(all.begin(), all.end(), first);
  into.add(all, information(position, attitude));
}

CorrectionKnots::PriorOf CorrectionKnots::prior(const ScaleFactors& position, const ScaleFactors& attitude) const {
  if (!chains_)
    return [C = covariance(position, attitude)](const std::vector<int>& numbers) -> Eigen::MatrixXd { return C(numbers, numbers); };
  return [this, factors = CorrectionChains::Factors{position, attitude}](const std::vector<int>& numbers) {
    Eigen::MatrixXd C(numbers.size(), numbers.size());
    for (size_t i = 0; i < numbers.size(); ++i)
      for (size_t j = 0; j < numbers.size(); ++j) {
        const KnotOf &a = knot_of_[static_cast<size_t>(numbers[i])], &b = knot_of_[static_cast<size_t>(numbers[j])];
        C(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            chains_->covariance(factors, a.line, {a.knot, b.knot}, {a.component, b.component});
      }
    return C;
  };
}

double CorrectionKnots::mean_square(bool position, std::optional<CorrectionScale> scale) const {
  const auto n = std::count(is_position_.begin(), is_position_.end(), position);
  if (n == 0) return 0.0;
  const auto over = [n](double sum) { return std::max(0.0, sum) / static_cast<double>(n); };
  if (chains_) {
    if (scale) return over(chains_->squares(position, *scale));
    return over(chains_->squares(position, line_mean) + chains_->squares(position, line_drift) + chains_->squares(position, within_line));
  }
  const auto share = [&](CorrectionScale s) { return (modes(position, s).transpose() * covariance_ * modes(position, s)).trace(); };
  if (scale && *scale != within_line) return over(share(*scale));
  double all = 0.0;
  for (int i = 0; i < size_; ++i)
    if (is_position(i) == position) all += covariance_(i, i);
  return over(scale ? all - share(line_mean) - share(line_drift) : all);
}

Eigen::MatrixXd CorrectionKnots::common_shift() const {
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(size(), 3);
  for (const Line& l : lines_)
    for (int k = 0; k < static_cast<int>(l.position.time.size()); ++k) B.block<3, 3>(l.position.first + 3 * k, 0).setIdentity();
  // A trend's first three are the means of the position.
  if (chains_ && !lines_.front().position.time.empty())
    for (int t = 0, of_line = 2 * static_cast<int>(chains_->components()); t < trends_; t += of_line)
      B.block<3, 3>(size_ + t, 0).setIdentity();
  return B;
}

}  // namespace swath::calib
