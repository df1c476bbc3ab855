// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/adjustment.h"

#include <cmath>

#include "calib/adjust/tie_normals.h"

namespace swath::calib {

std::string_view name_of(Grade g) {
  switch (g) {
    case Grade::held:
      return "held";
    case Grade::good:
      return "good";
    case Grade::coarse:
      return "coarse";
    case Grade::undetermined:
      return "undetermined";
    default:
      return "unsettled";
  }
}

// A withdrawn value keeps its start, whose error e0 has the prior's variance. With P = (A^-1 + H^T R^-1 H)^-1 the others' errors are
// P (A^-1 e0 + H^T R^-1 v), and so Cov(e, e0) = P.
Eigen::MatrixXd delivered_covariance(const Adjustment& a) {
  constexpr int n = latency + 1;
  if (a.formal.rows() != n) return {};
  const auto scale = [&](int k) {
    const Estimate& e = a.estimates[static_cast<size_t>(k)];
    const double own = std::hypot(e.formal, e.held);
    return own > 0.0 ? e.found_sigma / own : 1.0;
  };
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n), L = a.held;
  for (int i = 0; i < n; ++i) {
    const Estimate& e = a.estimates[static_cast<size_t>(i)];
    if (e.estimated) L.row(i) *= e.delivered ? scale(i) : 0.0;
    if (!e.estimated) continue;
    for (int j = 0; j < n; ++j) {
      const Estimate& f = a.estimates[static_cast<size_t>(j)];
      if (!f.estimated || (!e.delivered && !f.delivered)) continue;
      out(i, j) = (e.delivered ? scale(i) : 1.0) * (f.delivered ? scale(j) : 1.0) * a.formal(i, j);
    }
    if (!e.delivered && std::isfinite(e.apriori)) out(i, i) = e.apriori * e.apriori;
  }
  return out + L * a.held_correlation * L.transpose();
}

std::vector<std::string> sentences(const std::vector<Finding>& findings) {
  std::vector<std::string> out;
  for (const Finding& f : findings) out.push_back(f.what + (f.cure.empty() ? "" : ": " + f.cure));
  return out;
}

void withdraw(Adjustment& a, const std::vector<Parameter>& parameters, Grade grade) {
  for (const Parameter p : parameters) {
    Estimate& e = a.estimates[p];
    if (!e.estimated) continue;
    e.delivered = false;
    e.grade = grade;
    e.value = e.start;
    e.sigma = e.apriori;
    set_value(a.calibration, p, e.start);
  }
}

}  // namespace swath::calib
