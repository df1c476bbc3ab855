// SPDX-License-Identifier: GPL-3.0-or-later
// B-splines after de Boor 2001 ("A Practical Guide to Splines"), chapters IX and X, on even knots; third differences of the coefficients
// are held small by a penalty (Eilers and Marx 1996, "Flexible smoothing with B-splines and penalties") that only gaps and ends feel:
// with n samples per knot interval it shifts the fit by about 1e-4 / n of the coefficients' sixth difference.
#include "simulate/smooth_spline.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace swath::simulate {
namespace {

constexpr int degree = 5, width = degree + 1;
constexpr double penalty = 1e-4;

/// The splines of degree `p` that are not zero at place u of a knot interval, p + 1 of them.
template <int p>
std::array<double, p + 1> basis(double u) {
  std::array<double, p + 1> b{1.0};
  for (int j = 1; j <= p; ++j) {
    double saved = 0.0;
    for (int r = 0; r < j; ++r) {
      const auto k = static_cast<size_t>(r);
      const double part = b[k] / j;
      b[k] = saved + (r + 1 - u) * part;
      saved = (u + j - r - 1) * part;
    }
    b[static_cast<size_t>(j)] = saved;
  }
  return b;
}

/// Symmetric banded equations, solved by L D L^T; row i holds columns i to i + degree.
struct Banded {
  std::vector<std::array<double, width>> upper;
  void add(size_t i, size_t j, double v) { upper[i][j - i] += v; }  // i <= j

  void solve(std::vector<SmoothSpline::Row>& b) {
    const size_t n = upper.size();
    for (size_t i = 0; i < n; ++i) {
      for (size_t j = i + 1; j < std::min(n, i + width); ++j) {
        const double factor = upper[i][j - i] / upper[i][0];
        for (size_t k = j; k < std::min(n, i + width); ++k) upper[j][k - j] -= factor * upper[i][k - i];
        b[j] -= factor * b[i];
      }
    }
    for (size_t i = n; i-- > 0;) {
      for (size_t k = i + 1; k < std::min(n, i + width); ++k) b[i] -= upper[i][k - i] * b[k];
      b[i] /= upper[i][0];
    }
  }
};

}  // namespace

SmoothSpline::SmoothSpline(const std::vector<double>& time, const std::vector<Row>& values, double spacing)
    : begin_(time.front()), spacing_(spacing) {
  intervals_ = std::max(1, static_cast<int>(std::ceil((time.back() - begin_) / spacing - 1e-9)));
  const auto n = static_cast<size_t>(intervals_ + degree);
  Banded normal;
  normal.upper.assign(n, {});
  coefficients_.assign(n, Row::Zero());
  for (size_t s = 0; s < time.size(); ++s) {
    double u = 0.0;
    const auto first = static_cast<size_t>(interval_of(time[s], u));
    const auto b = basis<degree>(u);
    for (size_t i = 0; i < width; ++i) {
      coefficients_[first + i] += b[i] * values[s];
      for (size_t j = i; j < width; ++j) normal.add(first + i, first + j, b[i] * b[j]);
    }
  }
  constexpr std::array<double, 4> difference{-1, 3, -3, 1};
  for (size_t first = 0; first + 4 <= n; ++first)
    for (size_t i = 0; i < 4; ++i)
      for (size_t j = i; j < 4; ++j) normal.add(first + i, first + j, penalty * difference[i] * difference[j]);
  normal.solve(coefficients_);
}

int SmoothSpline::interval_of(double t, double& u) const {
  const double place = (t - begin_) / spacing_;
  const int k = std::clamp(static_cast<int>(std::floor(place)), 0, intervals_ - 1);
  u = place - k;
  return k;
}

SmoothSpline::At SmoothSpline::at(double t) const {
  double u = 0.0;
  const auto k = static_cast<size_t>(interval_of(t, u));
  const auto b5 = basis<5>(u);
  const auto b4 = basis<4>(u);
  const auto b3 = basis<3>(u);
  At out{Row::Zero(), Row::Zero(), Row::Zero()};
  const auto c = [&](size_t i) -> const Row& { return coefficients_[k + i]; };
  for (size_t i = 0; i < 6; ++i) out.value += b5[i] * c(i);
  for (size_t i = 0; i < 5; ++i) out.rate += b4[i] * (c(i + 1) - c(i));
  for (size_t i = 0; i < 4; ++i) out.acceleration += b3[i] * (c(i + 2) - 2 * c(i + 1) + c(i));
  out.rate /= spacing_;
  out.acceleration /= spacing_ * spacing_;
  return out;
}

}  // namespace swath::simulate
