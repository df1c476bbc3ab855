// SPDX-License-Identifier: GPL-3.0-or-later
// Source: variance = v^T P v / redundancy of the component (Foerstner 1979). The redundancy of the IMU is what all observations together
// have less that of the others: its own trace is a difference of numbers alike to 1e-7 and beyond.
#include "calib/network/network_components.h"

#include <array>
#include <cmath>
#include <limits>

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double least_freedom = 3.0;

/// Number of unknowns that observations of one kind determine: trace(W A C A^T).
double determined_by(const std::vector<NetworkNormals::Part>& parts, const MatrixXd& W, const Network& network) {
  std::vector<int> nodes;
  Eigen::Index columns = 0;
  for (const auto& [node, part] : parts)
    if (part.cols() > 0) nodes.push_back(node), columns += part.cols();  // nothing common to the flight may be unknown
  MatrixXd A(W.rows(), columns);
  columns = 0;
  for (const auto& [node, part] : parts) {
    A.middleCols(columns, part.cols()) = part;
    columns += part.cols();
  }
  return W.cwiseProduct(A * network.covariance(nodes) * A.transpose()).sum();
}

/// The rows of a passage that are the fixes' correlated error: the last three, where there are any.
std::vector<NetworkNormals::Part> last_rows(const std::vector<NetworkNormals::Part>& parts, Eigen::Index n) {
  std::vector<NetworkNormals::Part> out;
  for (const auto& [node, A] : parts) out.emplace_back(node, A.bottomRows(n));
  return out;
}

struct Name {
  const char *key, *words;
};
/// In the order of NavigationKind.
constexpr std::array<Name, 7> names{{{"start", "start of the navigation"},
                                     {"imu", "IMU"},
                                     {"gnss_correlated", "GNSS, error correlated in time"},
                                     {"gnss_position", "GNSS position"},
                                     {"gnss_velocity", "GNSS velocity"},
                                     {"standstill", "standstill"},
                                     {"wheels", "wheels"}}};
constexpr auto imu = static_cast<size_t>(NavigationKind::imu), fix_error = static_cast<size_t>(NavigationKind::fix_error);

void add(KindSums& sums, const std::vector<NetworkNormals::Part>& parts, const MatrixXd& W, const VectorXd& left, const Network& network) {
  sums.observations += static_cast<std::uint64_t>(left.size());
  sums.redundancy += static_cast<double>(left.size()) - determined_by(parts, W, network);
  sums.squares += left.dot(W * left);
}

/// Start values of the calibration, as far as they have sigmas.
KindSums start_values(const Network& network, const std::vector<double>& apriori) {
  KindSums out;
  if (apriori.empty()) return out;
  const MatrixXd covariance = network.calibration_covariance();
  for (size_t i = 0; i < apriori.size(); ++i) {
    if (!std::isfinite(apriori[i])) continue;
    const auto at = static_cast<Eigen::Index>(i);
    ++out.observations;
    out.redundancy += 1.0 - covariance(at, at) / (apriori[i] * apriori[i]);
  }
  return out;
}

}  // namespace

std::vector<NetworkComponent> components_of(const Network& network, const PlaneTests& tests, const std::vector<double>& apriori) {
  std::array<KindSums, names.size()> sums;
  const Eigen::Index fixes = network.has_fix_error() ? 3 : 0;
  network.each([&](NavigationKind k, const std::vector<NetworkNormals::Part>& parts, const MatrixXd& W, const VectorXd& left) {
    if (k != NavigationKind::imu) return add(sums[static_cast<size_t>(k)], parts, W, left, network);
    const Eigen::Index own = left.size() - fixes;
    sums[imu].observations += static_cast<std::uint64_t>(own);
    sums[imu].squares += left.head(own).dot(W.topLeftCorner(own, own) * left.head(own));
    if (fixes > 0) add(sums[fix_error], last_rows(parts, fixes), W.bottomRightCorner(fixes, fixes), left.tail(fixes), network);
  });
  // Planes are unknowns, too: three each.
  const KindSums values = start_values(network, apriori);
  double all = -static_cast<double>(network.last_step().size()) - 3.0 * static_cast<double>(tests.planes), others = 0.0;
  for (const KindSums* s : {&values, &tests.means, &tests.returns, &tests.control})
    all += static_cast<double>(s->observations), others += s->redundancy;
  for (size_t k = 0; k < sums.size(); ++k) {
    all += static_cast<double>(sums[k].observations);
    if (k != imu) others += sums[k].redundancy;
  }
  sums[imu].redundancy = all - others;

  std::vector<NetworkComponent> out;
  const auto put = [&out](const Name& name, const KindSums& s) {
    if (s.observations == 0) return;
    const double factor = s.redundancy < least_freedom ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(s.squares / s.redundancy);
    out.push_back({name.key, name.words, s.observations, s.redundancy, factor});
  };
  for (size_t k = 0; k < sums.size(); ++k) put(names[k], sums[k]);
  put({"planes", "lines on planes, mean distances"}, tests.means);
  put({"returns", "returns about the mean of their line on a plane"}, tests.returns);
  put({"control", "surveyed points"}, tests.control);
  return out;
}

}  // namespace swath::calib
