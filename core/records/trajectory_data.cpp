// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/records/trajectory_data.h"

#include <algorithm>

namespace swath::core {

CovarianceSeries::Packed CovarianceSeries::pack(const Matrix9& covariance) {
  Packed out{};
  size_t at = 0;
  for (Eigen::Index i = 0; i < 9; ++i)
    for (Eigen::Index j = i; j < 9; ++j) out[at++] = covariance(i, j);
  return out;
}

CovarianceSeries::Matrix9 CovarianceSeries::unpack(const Packed& packed) {
  Matrix9 out;
  size_t at = 0;
  for (Eigen::Index i = 0; i < 9; ++i)
    for (Eigen::Index j = i; j < 9; ++j) out(i, j) = out(j, i) = packed[at++];
  return out;
}

CovarianceSeries::Matrix9 CovarianceSeries::at(double t) const {
  const auto after = std::upper_bound(time.begin(), time.end(), t);
  if (after == time.begin()) return unpack(upper.front());
  if (after == time.end()) return unpack(upper.back());
  const auto n = static_cast<size_t>(after - time.begin());
  const double share = (t - time[n - 1]) / (time[n] - time[n - 1]);
  return (1 - share) * unpack(upper[n - 1]) + share * unpack(upper[n]);
}

void ErrorLinks::resize(size_t instants, Eigen::Index n) {
  const auto width = static_cast<size_t>(n);
  states = n;
  time.assign(instants, 0.0);
  lefts.assign(6 * width * instants, 0.0);
  rights.assign(6 * width * instants, 0.0);
  links.assign(width * width * instants, 0.0);
}

CalibrationResponse::Matrix CalibrationResponse::at(double t) const {
  if (empty()) return Matrix::Zero();
  const auto next = std::upper_bound(time.begin(), time.end(), t);
  if (next == time.begin()) return per_unit.front();
  if (next == time.end()) return per_unit.back();
  const auto k = static_cast<size_t>(next - time.begin());
  const double share = (t - time[k - 1]) / (time[k] - time[k - 1]);
  return (1.0 - share) * per_unit[k - 1] + share * per_unit[k];
}

}  // namespace swath::core
