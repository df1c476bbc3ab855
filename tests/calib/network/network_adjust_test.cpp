// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/network/network_adjust.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <set>

#include "calib/adjust/start_sigmas.h"
#include "core/error.h"
#include "tests/calib/tie_world.h"
#include "tests/trajectory/ins_run.h"
#include "trajectory/compare.h"
#include "trajectory/ins/ins_gnss.h"

namespace swath::calib {
namespace {

using namespace test;
using swath::test::motion_start;

/// A MEMS survey of a village by parallel lines flown to and fro, 350 m above it, fixes of 1 Hz.
struct MemsSurvey {
  simulate::PlannedFlight flight;
  trajectory::test::Course course;
  core::TrajectoryData truth;
  TieWorld world;
  Flown shots;
  trajectory::SmoothedFlight left;
  std::unique_ptr<trajectory::Trajectory> smoothed;
  CalibrationFlight survey;

  /// How much a line (from 1) sees the surface farther away than it is, m.
  using Displacement = std::function<double(int line, const Eigen::Vector3d& point)>;

  explicit MemsSurvey(int lines, core::Calibration start_error = {}, const Displacement& displacement = {}, int cross_lines = 0)
      : flight(swath::test::survey_flight(lines, cross_lines)), course(swath::test::motion_of(flight), 0.0, flight.duration()) {
    for (double t = 0.02; t < flight.duration(); t += 0.02) append(t);
    const trajectory::Trajectory exact(truth, {}, "truth");
    std::vector<std::pair<double, double>> spans;
    for (const simulate::Line& l : flight.lines()) spans.emplace_back(motion_start + l.start, motion_start + l.end);
    survey.frame = world.frame = frame_of(spans, 350.0, exact);
    world.houses = village(60, 400.0, 5);
    world.prf = 6000.0;
    world.truth.roll = core::degrees(0.2);
    shoot(exact, spans, displacement);

    trajectory::test::Trial trial = trajectory::test::trial_of(core::ImuGrade::mems, 3);
    trial.change_gnss = [](core::GnssData& g) { g = swath::test::keep_fixes(g, [](size_t k) { return k % 5 == 0; }); };
    core::ImuData imu = swath::test::with_errors(course.exact.imu, core::error_model_of(core::ImuGrade::mems), 3);
    core::GnssData gnss = swath::test::with_errors(course.exact.gnss, trial.fixes, 3);
    trial.change_gnss(gnss);
    trajectory::InsGnssResult result =
        smooth(std::move(imu), std::move(gnss), trial.stated, course.sensors.lever, 0.02, {}, {}, core::unwatched, &left);
    smoothed = std::make_unique<trajectory::Trajectory>(std::move(result.trajectory));

    survey.shots = shots.stream();
    survey.scanner = world.scanner;
    survey.start = world.truth;
    survey.start.roll.value += start_error.roll.value;
    survey.sensor.range = core::Metres(0.02);
    survey.sensor.roll = core::degrees(0.05);
    survey.sensor.stated = {"roll"};
    survey.trajectory = smoothed.get();
    survey.scale = scale_of(350.0, 6000.0 / (50.0 * 255.0), survey.sensor);
    survey.threads = 2;
  }

  trajectory::Comparison errors(const core::TrajectoryData& of) const {
    std::vector<trajectory::Span> lines;
    for (const simulate::Line& l : flight.lines()) lines.push_back({motion_start + l.start, motion_start + l.end});
    return trajectory::compare(trajectory::errors_against(of, trajectory::Trajectory(truth, {}, "truth")), lines);
  }

 private:
  void append(double t) {
    const swath::test::Truth at = swath::test::truth_at(course.motion, t);
    const core::Geodetic g = core::geodetic_of(at.position);
    const core::Attitude a = core::attitude_of(core::ecef_R_ned(g.latitude, g.longitude).transpose() * at.ecef_R_body);
    truth.time.push_back(motion_start + t);
    truth.latitude.push_back(g.latitude), truth.longitude.push_back(g.longitude), truth.height.push_back(g.height);
    truth.roll.push_back(a.roll), truth.pitch.push_back(a.pitch), truth.heading.push_back(a.heading);
  }
  void shoot(const trajectory::Trajectory& exact, const std::vector<std::pair<double, double>>& spans, const Displacement& displacement) {
    std::mt19937 random(9);
    std::normal_distribution<double> normal;
    const ShotGeometry geometry(world.scanner, world.truth);
    trajectory::Cursor cursor(exact);
    for (size_t k = 0; k < spans.size(); ++k) {
      core::Shots out;
      for (double t = spans[k].first; t < spans[k].second; t += 1.0 / world.prf) {
        cursor.seek(t);
        const double phase = t * world.scans - std::floor(t * world.scans);
        const double angle = world.half_angle * (phase < 0.5 ? 4.0 * phase - 1.0 : 3.0 - 4.0 * phase);
        const auto point = [&](double range) -> Eigen::Vector3d {
          return world.frame.local_R_ecef * (geometry.ecef_point(cursor.pose(t), {angle, 0.0, range}) - world.frame.origin);
        };
        const Eigen::Vector3d one = point(1000.0), way = point(1001.0) - one, from = one - 1000.0 * way;
        out.time.push_back(t);
        out.angle.push_back(angle);
        const double range = world.hit(from, way);
        const double off = displacement ? displacement(static_cast<int>(k) + 1, from + range * way) : 0.0;
        out.range.push_back(range + off + 0.02 * normal(random));
        out.return_number.push_back(1), out.return_count.push_back(1);
      }
      shots.lines.emplace_back(static_cast<int>(k) + 1, std::move(out));
    }
  }
};

NetworkOptions quick() {
  NetworkOptions o;
  o.planes.planes = 600;
  o.planes.returns = 40;
  o.rounds = 2;
  return o;
}

TEST(NetworkAdjust, PlanesMakeTheAttitudeOfAMemsSurveyBetterAndItsSigmasTrue) {
  const MemsSurvey made(3);
  core::Tally tally;
  const AdjustedNetwork network = adjust_network(made.survey, made.left, quick(), tally);
  EXPECT_TRUE(network.settled);
  const trajectory::Comparison before = made.errors(made.smoothed->data()), after = made.errors(network.trajectory);
  double pull = 0;
  for (size_t c = 0; c < 6; ++c) {
    std::printf("%s: rms %.4g -> %.4g, error/sigma %.2f -> %.2f\n", std::string(trajectory::Comparison::names[c]).c_str(),
                before.component[c].rms, after.component[c].rms, before.component[c].over_sigma, after.component[c].over_sigma);
    pull += std::pow(after.component[c].over_sigma, 2) / 6;
  }
  EXPECT_LT(after.component[3].rms, 0.2 * before.component[3].rms);  // seen: a sixteenth
  EXPECT_LT(after.component[2].rms, 0.8 * before.component[2].rms);
  EXPECT_LT(after.component[5].rms, before.component[5].rms);  // parallel lines hardly see the heading
  EXPECT_LT(std::sqrt(pull), 1.6);                             // one flight: six components that hardly change within it
  const PlaneAgreement planes = agreement_on_planes(network);
  EXPECT_GT(planes.pairs, 50u);
  EXPECT_LT(planes.after, 0.5 * planes.before);
  EXPECT_EQ(network.trajectory.covariance.time.size(), network.instants);
  EXPECT_LT(network.surface_sigma, 0.0015);  // the village's planes are exact, 0.003 m was the start
  EXPECT_EQ(network.biases.size(), network.instants);
  EXPECT_EQ(network.tests.group.size(), network.after.size());
  for (const NetworkComponent& c : network.components)
    if (c.kind == "planes" || c.kind == "returns" || c.kind == "gnss_position") {
      EXPECT_NEAR(c.factor, 1.0, 0.25) << c.kind;
    }
}

TEST(NetworkAdjust, FindsTheBoresightWithTheTrajectory) {
  core::Calibration off;
  off.roll = core::degrees(0.04);
  const MemsSurvey made(3, off);
  core::Tally tally;
  NetworkOptions o = quick();
  o.estimate.roll = true;
  o.apriori = start_sigmas(made.survey.sensor);
  const AdjustedNetwork network = adjust_network(made.survey, made.left, o, tally);
  ASSERT_EQ(network.values.size(), 1u);
  const NetworkValue& v = network.values.front();
  EXPECT_EQ(v.parameter, boresight_roll);
  EXPECT_LT(v.sigma, 0.5 * core::degrees(0.05).value);  // an accelerometer's bias across tilts the body as the boresight does
  EXPECT_LT(std::abs(v.value - made.world.truth.roll.value), 4 * v.sigma);
  EXPECT_EQ(network.calibration.roll.value, v.value);
}

const VarianceComponent& sigma_of(const AdjustedNetwork& network, const std::string& name) {
  const auto found = std::find_if(network.sigmas.begin(), network.sigmas.end(), [&](const VarianceComponent& v) { return v.name == name; });
  return found == network.sigmas.end() ? throw std::out_of_range(name) : *found;
}

TEST(NetworkAdjust, AWronglyStatedSigmaOfRangesIsFound) {
  MemsSurvey made(3);
  made.survey.sensor.range = core::Metres(0.05);  // it is 0.02 m
  core::Tally tally;
  NetworkOptions o = quick();
  o.rounds = 1;
  const AdjustedNetwork network = adjust_network(made.survey, made.left, o, tally);
  const VarianceComponent& range = sigma_of(network, "range");
  EXPECT_TRUE(range.estimated);
  EXPECT_EQ(range.stated, 0.05);
  EXPECT_NEAR(range.factor, 0.4, 0.04);
  EXPECT_NEAR(network.noise_factor, 1.0, 0.1);
}

constexpr double cell = 20.0;  // m

TEST(NetworkAdjust, RoughSurfacesRaiseTheirSigmaAndAreNotRejected) {
  constexpr double rough = 0.02;
  const MemsSurvey made(3, {}, [](int line, const Eigen::Vector3d& p) {
    const auto at = [](double x) { return static_cast<unsigned>(std::lround(x / cell) + 1000); };
    std::seed_seq seed{at(p.x()), at(p.y()), static_cast<unsigned>(line)};
    std::mt19937 random(seed);
    return rough * std::normal_distribution<double>()(random);
  });
  core::Tally tally;
  constexpr int rounds = 1;  // the sigma settles within it
  NetworkOptions o = quick();
  o.rounds = rounds;
  const AdjustedNetwork network = adjust_network(made.survey, made.left, o, tally);
  std::printf("%d rounds: surface %.4f m, displaced %llu, left out %llu of %zu\n", rounds, network.surface_sigma,
              static_cast<unsigned long long>(network.displaced), static_cast<unsigned long long>(network.left_out), network.after.size());
  EXPECT_TRUE(network.surface_estimated);
  EXPECT_GT(network.surface_sigma, 0.6 * rough);  // planes across the border of two cells have less
  EXPECT_LT(network.surface_sigma, 1.2 * rough);
  EXPECT_LT(static_cast<double>(network.displaced), 0.02 * static_cast<double>(network.after.size()));
  EXPECT_EQ(sigma_of(network, "surface").factor, network.surface_sigma / 0.003);
}

/// A house's roof and walls: higher than the ground about it.
bool lies_on(const House& h, const Eigen::Vector3d& p) { return (p.head<2>() - h.centre).norm() < h.radius && p.z() > 2.0; }

/// The house on whose roof `network` has a plane that three lines see, `line` (index) among them.
const House* thrice_seen(const AdjustedNetwork& network, const std::vector<House>& houses, std::uint32_t line) {
  for (std::uint32_t k = 0; k < network.planes.size(); ++k) {
    std::set<std::uint32_t> lines;
    for (const TieGroup& g : network.ties.groups)
      if (g.plane == k) lines.insert(g.line);
    if (lines.size() < 3 || !lines.contains(line)) continue;
    for (const House& h : houses)
      if (lies_on(h, network.planes[k].centre)) return &h;
  }
  return nullptr;
}

// A house that moved between two lines does no harm. With few groups on a plane the others of it may go, too, nothing else does.
TEST(NetworkAdjust, AHouseDisplacedInOneLineIsLeftOutAndNothingBeside) {
  constexpr int line = 2;           // of four, the last of them across
  constexpr double farther = 0.25;  // m
  NetworkOptions o = quick();
  o.rounds = 1;
  o.snooping.alpha = 1e-5;  // no false alarm among some hundred groups
  core::Tally tally;
  const MemsSurvey sound(3, {}, {}, 1);
  const AdjustedNetwork without = adjust_network(sound.survey, sound.left, o, tally);
  EXPECT_EQ(without.displaced, 0u);
  EXPECT_EQ(without.left_out, 0u);
  const House* house = thrice_seen(without, sound.world.houses, line - 1);
  ASSERT_NE(house, nullptr);

  const MemsSurvey made(
      3, {}, [house](int of, const Eigen::Vector3d& p) { return of == line && lies_on(*house, p) ? farther : 0.0; }, 1);
  const AdjustedNetwork network = adjust_network(made.survey, made.left, o, tally);
  int displaced = 0;
  for (size_t g = 0; g < network.ties.groups.size(); ++g) {
    const TieGroup& group = network.ties.groups[g];
    const bool is_of_house = lies_on(*house, network.planes[group.plane].centre);
    const bool is_displaced = group.line == line - 1 && is_of_house;
    if (network.after[g].weight > 0.0) {
      EXPECT_FALSE(is_displaced) << "line " << group.line + 1 << " on plane " << group.plane << " is not left out";
    } else {
      EXPECT_TRUE(is_of_house) << "line " << group.line + 1 << " on plane " << group.plane << " is left out";
    }
    displaced += is_displaced;
  }
  std::printf("%d groups displaced, %llu left out, %llu by the test\n", displaced, static_cast<unsigned long long>(network.left_out),
              static_cast<unsigned long long>(network.displaced));
  EXPECT_GT(displaced, 0);
}

TEST(NetworkAdjust, OneLineAloneIsRefusedWithWhatWasSought) {
  const MemsSurvey made(1);
  core::Tally tally;
  try {
    adjust_network(made.survey, made.left, quick(), tally);
    FAIL() << "nothing was refused";
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("plane"), std::string::npos) << e.text();
  }
}

}  // namespace
}  // namespace swath::calib
