// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/geo/geodesy.h"

namespace swath::core {

/// The Error an action throws, as text; fails where it throws none.
template <class Action>
std::string refusal(Action action) {
  try {
    action();
  } catch (const Error& e) {
    EXPECT_FALSE(e.hint().empty()) << e.text();
    return e.text();
  }
  ADD_FAILURE() << "was not refused";
  return {};
}
inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// UTM north by Krueger's series in the third flattening to n^4 (Krueger 1912; Karney, J. Geodesy 85, 2011, eqs. 6-12, 35): independent of
/// PROJ. Cut below 1 um within 4 deg of the meridian.
inline Eigen::Vector2d utm_by_krueger(double latitude, double longitude, double meridian) {
  const double n = wgs84::f / (2.0 - wgs84::f), n2 = n * n, n3 = n2 * n, n4 = n2 * n2;
  const double A = wgs84::a / (1 + n) * (1 + n2 / 4 + n4 / 64);
  const double alpha[] = {n / 2 - 2 * n2 / 3 + 5 * n3 / 16 + 41 * n4 / 180, 13 * n2 / 48 - 3 * n3 / 5 + 557 * n4 / 1440,
                          61 * n3 / 240 - 103 * n4 / 140, 49561 * n4 / 161280};
  const double e = std::sqrt(wgs84::e2), tau = std::tan(latitude);
  const double sigma = std::sinh(e * std::atanh(e * tau / std::hypot(1.0, tau)));
  const double tau_c = tau * std::hypot(1.0, sigma) - sigma * std::hypot(1.0, tau);
  const double dl = longitude - meridian;
  const double xi_c = std::atan2(tau_c, std::cos(dl)), eta_c = std::asinh(std::sin(dl) / std::hypot(tau_c, std::cos(dl)));
  double xi = xi_c, eta = eta_c;
  for (int j = 1; j <= 4; ++j) {
    xi += alpha[j - 1] * std::sin(2 * j * xi_c) * std::cosh(2 * j * eta_c);
    eta += alpha[j - 1] * std::cos(2 * j * xi_c) * std::sinh(2 * j * eta_c);
  }
  return {500000.0 + 0.9996 * A * eta, 0.9996 * A * xi};
}

}  // namespace swath::core
