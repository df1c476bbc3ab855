// SPDX-License-Identifier: GPL-3.0-or-later
// The memory that survey stages state before they begin, against what whole runs took (docs/performance.md).
#include <gtest/gtest.h>

#include <string>

#include "core/config/option_visitors.h"
#include "io/text/value_file.h"
#include "stages/registry.h"

namespace swath::stages {
namespace {

core::ImuData records_of(double seconds, double rate) {
  core::ImuData imu;
  const auto n = static_cast<size_t>(seconds * rate) + 1;
  for (size_t k = 0; k < n; ++k) imu.time.push_back(static_cast<double>(k) / rate);
  imu.step.assign(n, 1.0 / rate);
  imu.angle.assign(n, Eigen::Vector3d::Zero());
  imu.velocity.assign(n, Eigen::Vector3d::Zero());
  return imu;
}

/// What a stage states for a flight; `options` as TOML.
double stated(const std::string& type, double seconds, double rate, const std::string& options = {}) {
  const io::Survey survey;
  Context context{survey};
  context.records.put(records_of(seconds, rate));
  const auto stage = make_stage(type);
  std::vector<core::Fault> faults;
  core::read_options([&](core::Visitor& v) { stage->visit(v); }, io::parse_toml(options, "test"), "", faults);
  EXPECT_TRUE(faults.empty());
  return stage->survey_memory(context);
}

/// The figures are of whole processes, what the program itself takes with them.
void expect_near_measured(double bytes, double measured, const std::string& what) {
  EXPECT_GT(bytes, 0.75 * measured) << what;
  EXPECT_LT(bytes, 1.1 * measured) << what;
}

constexpr double hour = 3600.0, gigabyte = 1e9;

TEST(SurveyMemory, TheSmootherTakesWhatFlightsOfAnHourAndOfFourTook) {
  // Peaks of 0.39 and 0.89 GB, of which records before the smoother are 0.05 and 0.20 GB.
  expect_near_measured(stated("trajectory.ins_gnss", hour, 200.0), (0.39 - 0.05) * gigabyte, "1 h");
  expect_near_measured(stated("trajectory.ins_gnss", 4 * hour, 200.0), (0.89 - 0.20) * gigabyte, "4 h");
}

TEST(SurveyMemory, TheSmootherGrowsWithRecordsAndToAStretchOfNodes) {
  const auto smoother = [](double seconds, double rate, const std::string& spacing) {
    return stated("trajectory.ins_gnss", seconds, rate, "node_spacing = \"" + spacing + "\"");
  };
  constexpr double per_record = 162.0, per_node = 11e3;  // bytes
  EXPECT_NEAR(smoother(1000, 200, "1 s") - smoother(1000, 100, "1 s"), per_record * 100e3, 1.0);
  EXPECT_NEAR(smoother(1000, 100, "0.5 s") - smoother(1000, 100, "1 s"), per_node * 1000, 1.0);
  // Of 20 000 nodes on it holds matrices of a stretch at a time.
  EXPECT_NEAR(smoother(2e4, 1, "0.5 s"), smoother(2e4, 1, "1 s"), 1.0);
  EXPECT_EQ(stated("trajectory.ins_gnss", 0, 100), per_record);
}

TEST(SurveyMemory, TheNetworkTakesWhatBlocksOfTenAndFiftyLinesTook) {
  constexpr double per_instant = 0.125e6;  // bytes: factor, inverse and observations
  struct Block {
    double instants, gigabytes;
  };
  for (const Block& b : {Block{6455, 1.02}, Block{31915, 4.8}}) {
    const double seconds = 0.5 * b.instants;
    const double bytes = stated("calib.network", seconds, 200.0, "[smoother]\nnode_spacing = \"0.5 s\"\n");
    expect_near_measured(bytes, b.gigabytes * gigabyte, std::to_string(b.instants));
    EXPECT_NEAR(bytes - stated("trajectory.ins_gnss", seconds, 200.0, "node_spacing = \"0.5 s\""), per_instant * b.instants, per_instant);
  }
}

}  // namespace
}  // namespace swath::stages
