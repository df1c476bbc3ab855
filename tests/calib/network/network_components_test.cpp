// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/network/network_components.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/calib/network/network_flight.h"

namespace swath::calib {
namespace {

std::map<std::string, NetworkComponent> components(const test::NetworkFlight& made, const trajectory::Problem& problem) {
  Network network(problem, made.reference, {}, made.prior());
  network.solve();
  network.invert();
  std::map<std::string, NetworkComponent> out;
  for (const NetworkComponent& c : components_of(network, {}, {})) out[c.kind] = c;
  return out;
}

TEST(NetworkComponents, ResidualsOfARightModelHaveTheirSigmas) {
  const test::NetworkFlight made(40.0, true);
  const auto found = components(made, *made.flight.problem);
  for (const auto& [kind, c] : found)
    std::printf("%s: %llu observations, redundancy %.1f, factor %.3f\n", kind.c_str(), static_cast<unsigned long long>(c.observations),
                c.redundancy, c.factor);
  EXPECT_EQ(found.count("wheels"), 0u);
  EXPECT_EQ(found.count("planes"), 0u);
  for (const char* kind : {"gnss_position", "gnss_velocity"}) {
    const NetworkComponent& c = found.at(kind);
    EXPECT_GT(c.redundancy, 0.8 * static_cast<double>(c.observations));  // many fixes for a smooth flight
    EXPECT_NEAR(c.factor, 1.0, 4 / std::sqrt(2 * c.redundancy));
  }
  // Hardly anything contradicts the IMU: each of its equations has unknowns of its own.
  EXPECT_GE(found.at("imu").redundancy, 0.0);
  EXPECT_LT(found.at("imu").redundancy, 0.1 * static_cast<double>(found.at("imu").observations));
}

TEST(NetworkComponents, AFlightWithoutCommonUnknownsHasThem) {
  const trajectory::Layout navigation_alone(false, false, true, false, false);
  const test::NetworkFlight made(10.0, true, core::ImuGrade::tactical, navigation_alone);
  const auto found = components(made, *made.flight.problem);
  EXPECT_GT(found.at("gnss_position").redundancy, 0.0);
  EXPECT_GT(found.at("gnss_correlated").observations, 0u);
}

/// A calibration value that is known twice over: what its start value has of redundancy is not the IMU's.
TEST(NetworkComponents, StartValuesOfTheCalibrationTakeNothingOfTheImu) {
  const test::NetworkFlight made(10.0, true);
  const auto imu = [&](int values) {
    Network network(*made.flight.problem, made.reference, {}, made.prior(), values);
    constexpr double sigma = 1e-3;
    network.solve([&](NetworkNormals& into) {
      const int node = network.states().common();
      for (int i = 0; i < values; ++i) {
        Eigen::MatrixXd one = Eigen::MatrixXd::Zero(1, into.N.size(node));
        one(0, network.states().calibration_first() + i) = 1.0;
        // Its start value, and another observation as good.
        for (int n = 0; n < 2; ++n)
          into.add({{node, one}}, Eigen::MatrixXd::Constant(1, 1, 1.0 / (sigma * sigma)), -network.calibration().segment(i, 1));
      }
    });
    network.invert();
    PlaneTests other;
    other.control.observations = static_cast<std::uint64_t>(values);
    other.control.redundancy = 0.5 * values;
    for (const NetworkComponent& c : components_of(network, other, std::vector<double>(static_cast<size_t>(values), sigma)))
      if (c.kind == "imu") return c.redundancy;
    return -1.0;
  };
  EXPECT_NEAR(imu(6), imu(0), 0.05);
}

TEST(NetworkComponents, FixesThatAreWorseThanTheyStateShow) {
  const test::NetworkFlight made(40.0, true);
  core::GnssData boastful = made.flight.gnss;
  for (Eigen::Matrix3d& c : boastful.covariance) c /= 9.0;
  trajectory::Problem problem{
      made.flight.path, boastful, made.flight.nodes, made.layout(), made.flight.problem->noise, made.flight.problem->options};
  problem.share = 0.02;
  const double factor = components(made, problem).at("gnss_position").factor;
  EXPECT_GT(factor, 1.7);
  EXPECT_LT(factor, 3.5);
}

}  // namespace
}  // namespace swath::calib
