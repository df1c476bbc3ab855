// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/adjust.h"

#include <gtest/gtest.h>

#include <numeric>

#include "calib/adjust/parameter_words.h"
#include "tests/calib/adjust_support.h"

namespace swath::calib {
namespace {

using namespace test;
using Eigen::Vector3d;

TEST(Adjust, ExactRecordsGiveTheExactCalibration) {
  World w = pattern_of(full_pattern());
  w.truth.latency = core::Seconds(0.004);
  w.truth.range_scale = 1.00005;
  survey(w.planes[3], 0.02, nullptr);
  survey(w.planes[30], 0.02, nullptr);
  survey(w.planes[35], 0.02, nullptr);
  const TieSet ties = ties_of(w, nullptr);
  const trajectory::Trajectory t(w.exact);
  AdjustOptions o = plain();
  o.corrections.position = o.corrections.attitude = CorrectionForm::none;
  o.estimate.range_scale = o.estimate.latency = true;
  o.apriori = {};
  o.apriori.roll = o.apriori.pitch = o.apriori.heading = core::Radians(0.0);  // free: the start counts for nothing
  o.apriori.range_offset = core::Metres(0.0);
  o.apriori.range_scale = o.apriori.scan_scale = 0.0;
  o.apriori.latency = core::Seconds(0.0);
  core::Calibration start;
  start.lever_arm_scanner = w.truth.lever_arm_scanner;
  const Adjustment a = adjust(ties, w.scanner, start, w.noise, t, tactical_errors, o);
  EXPECT_NEAR(a.calibration.roll.value, w.truth.roll.value, 1e-9);
  EXPECT_NEAR(a.calibration.pitch.value, w.truth.pitch.value, 1e-9);
  EXPECT_NEAR(a.calibration.heading.value, w.truth.heading.value, 1e-9);
  EXPECT_NEAR(a.calibration.range_offset.value, w.truth.range_offset.value, 1e-5);
  EXPECT_NEAR(a.calibration.scan_scale, w.truth.scan_scale, 1e-8);
  EXPECT_NEAR(a.calibration.range_scale, w.truth.range_scale, 1e-8);
  EXPECT_NEAR(a.calibration.latency.value, w.truth.latency.value, 1e-7);
  EXPECT_TRUE(a.converged);
  for (const GroupResidual& g : a.groups) EXPECT_LT(std::abs(g.after), 1e-6);
  EXPECT_GT(std::abs(a.groups[0].before), 0.01);
  EXPECT_EQ(a.correlation.rows(), 7);
  EXPECT_EQ(a.corrections.size(), w.lines.size());
}

// The same from a motion and an equation that know nothing of calib: turbulence, crab, boresight as a product of three turns.
TEST(Adjust, AgreesWithAnIndependentFlight) {
  simulate::PlannedFlight flight = swath::test::survey_flight(3);
  const std::vector<simulate::Line> lines = flight.lines();
  const core::Geodetic middle = flight.pose(0.5 * (lines[1].start + lines[1].end)).position;
  const swath::test::MotionAt motion = swath::test::motion_of(flight);
  const double epoch = swath::test::motion_start;
  TieSet ties;
  ties.frame = trajectory::local_frame(core::ecef_of({middle.latitude, middle.longitude, middle.height - 700.0}));
  core::TrajectoryData data;
  const double roll = 0.003, pitch = -0.004, heading = 0.006, offset = 0.11, scale = 1.0003;
  const Vector3d lever(0.3, -0.2, 0.4);
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(heading, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
                                Eigen::AngleAxisd(roll, Vector3d::UnitX()))
                                   .matrix();
  ties.planes = block_planes(4, 25, 11);
  std::vector<std::vector<std::array<double, 3>>> found(ties.planes.size() * lines.size());
  for (size_t l = 0; l < lines.size(); ++l) {
    ties.lines.push_back({static_cast<int>(l), epoch + lines[l].start, epoch + lines[l].end});
    for (double s = lines[l].start - 1.0; s <= lines[l].end + 1.0; s += 0.01) {
      const simulate::Motion m = motion(s);
      data.time.push_back(epoch + s);
      data.latitude.push_back(m.pose.position.latitude);
      data.longitude.push_back(m.pose.position.longitude);
      data.height.push_back(m.pose.position.height);
      data.roll.push_back(m.pose.attitude.roll);
      data.pitch.push_back(m.pose.attitude.pitch);
      data.heading.push_back(m.pose.attitude.heading);
    }
    // Scans of 25 deg either side; a return for every plane that the beam comes across.
    for (double s = lines[l].start; s < lines[l].end; s += 0.02) {
      const swath::test::Truth at = swath::test::truth_at(motion, s);
      for (double a = -25.0 * deg; a < 25.0 * deg; a += 0.25 * deg) {
        const Vector3d from = ties.frame.local_R_ecef * (at.position + at.ecef_R_body * lever - ties.frame.origin);
        const double turned = scale * a;
        const Vector3d beam = ties.frame.local_R_ecef * at.ecef_R_body * turn * Vector3d(0.0, std::sin(turned), std::cos(turned));
        for (size_t k = 0; k < ties.planes.size(); ++k) {
          const TiePlane& p = ties.planes[k];
          const double range = p.normal.dot(p.centre - from) / p.normal.dot(beam);
          if ((from + range * beam - p.centre).norm() < p.half.x()) found[k * lines.size() + l].push_back({epoch + s, a, range - offset});
        }
      }
    }
  }
  for (size_t k = 0; k < ties.planes.size(); ++k)
    for (size_t l = 0; l < lines.size(); ++l) {
      const auto& list = found[k * lines.size() + l];
      if (list.size() < 3) continue;
      const auto begin = static_cast<std::uint32_t>(ties.returns.size());
      for (const auto& [t, a, r] : list) {
        ties.returns.time.push_back(t);
        ties.returns.angle.push_back(a);
        ties.returns.forward.push_back(0.0);
        ties.returns.range.push_back(r);
      }
      ties.groups.push_back(
          {static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(l), begin, static_cast<std::uint32_t>(ties.returns.size())});
    }
  ASSERT_GT(ties.groups.size(), 60u);
  survey(ties.planes[2], 0.02, nullptr);
  survey(ties.planes[20], 0.02, nullptr);
  survey(ties.planes[31], 0.02, nullptr);
  AdjustOptions o = plain();
  o.corrections.position = o.corrections.attitude = CorrectionForm::none;
  core::Calibration start;
  for (int k = 0; k < 3; ++k) start.lever_arm_scanner[k] = core::Metres(lever[k]);
  o.apriori.roll = o.apriori.pitch = o.apriori.heading = core::Radians(0.0);
  o.apriori.range_offset = core::Metres(0.0);
  o.apriori.scan_scale = 0.0;
  const Adjustment a = adjust(ties, {}, start, {}, trajectory::Trajectory(data), tactical_errors, o);
  // GPS seconds resolve 2.4e-7 s: 0.015 mm of flight, 2e-8 rad at 700 m; many returns average it.
  constexpr double of_time = 1e-8;
  EXPECT_NEAR(a.estimates[boresight_roll].found, roll, of_time);
  EXPECT_NEAR(a.estimates[boresight_pitch].found, pitch, of_time);
  EXPECT_NEAR(a.estimates[boresight_heading].found, heading, 3.0 * of_time);
  EXPECT_NEAR(a.estimates[range_offset].found, offset, 1e-4);
  EXPECT_NEAR(a.estimates[scan_scale].found, scale, 1e-7);
}

// Error / sigma over many flights whose trajectories err as their covariance says.
struct MonteCarlo {
  std::array<std::vector<double>, latency + 1> standard, white;
  double rms(Parameter p) const {
    double s = 0.0;
    for (const double v : standard[p]) s += v * v;
    return std::sqrt(s / static_cast<double>(standard[p].size()));
  }
};
MonteCarlo fly(const World& w, int seeds, const AdjustOptions& o, int surveyed) {
  // Errors linear between the knots: the model is exact, what is tested is the statistics.
  const ErrorDraw draw(w, tactical_errors, o.corrections.spacing.value);
  MonteCarlo out;
  for (int s = 0; s < seeds; ++s) {
    Dice dice(static_cast<std::uint64_t>(4000 + s));
    World flown = w;
    for (int k = 0; k < surveyed; ++k) survey(flown.planes[static_cast<size_t>(9 * k + 3) % flown.planes.size()], 0.02, &dice);
    const TieSet ties = ties_of(flown, &dice, static_cast<std::uint64_t>(s));
    const trajectory::Trajectory t(draw.with_errors(w.exact, dice));
    core::Calibration start = w.truth;  // off by what the a-priori sigmas say
    start.roll.value += o.apriori.roll.value * dice.normal();
    start.pitch.value += o.apriori.pitch.value * dice.normal();
    start.heading.value += o.apriori.heading.value * dice.normal();
    start.range_offset.value += o.apriori.range_offset.value * dice.normal();
    start.scan_scale += o.apriori.scan_scale * dice.normal();
    for (core::Metres& arm : start.lever_arm_scanner) arm.value += w.noise.lever_arm.value * dice.normal();  // held, yet uncertain
    const Adjustment a = adjust(ties, w.scanner, start, w.noise, t, tactical_errors, o);
    for (const Estimate& e : a.estimates) {
      if (!e.estimated) continue;
      const double sigma = e.delivered ? e.sigma : std::hypot(e.formal, e.held);
      out.standard[e.parameter].push_back((e.found - value_of(w.truth, e.parameter)) / sigma);
      out.white[e.parameter].push_back(e.formal / e.white);
    }
  }
  return out;
}

// The rms of 60 standardised errors has itself a sigma of 9 %; one in twenty of several is beyond twice that.
constexpr double low = 0.8, high = 1.2;

TEST(Adjust, SigmasAreTrueOverManyFlights) {
  const World w =
      pattern_of({{0.0, 0.0}, {180.0 * deg, 0.0}, {90.0 * deg, 0.0}, {270.0 * deg, 0.0}, {0.0, 230.0}, {180.0 * deg, 230.0}}, 10, 8);
  const MonteCarlo m = fly(w, 60, plain(), 0);
  double mean = 0.0;
  for (const Parameter p : usual) {
    EXPECT_GT(m.rms(p), low) << words_of(p).name;
    EXPECT_LT(m.rms(p), high) << words_of(p).name;
    mean += m.rms(p) / static_cast<double>(usual.size());
  }
  EXPECT_NEAR(mean, 1.0, 0.12);
  // What every return as independent would have said.
  for (const Parameter p : {boresight_roll, boresight_pitch, boresight_heading})
    EXPECT_GT(std::accumulate(m.white[p].begin(), m.white[p].end(), 0.0) / static_cast<double>(m.white[p].size()),
              p == boresight_heading ? 3.0 : 4.0)
        << words_of(p).name;
}

// What the corrections of all lines lack of the trajectory's errors, over their sigmas: mean squares by component.
std::array<double, 6> squares_of_corrections(const Adjustment& a, const trajectory::Trajectory& flown,
                                             const trajectory::Trajectory& exact) {
  std::array<double, 6> out{};
  double n = 0.0;
  for (const LineCorrection& c : a.corrections)
    for (size_t k = 0; k < c.time.size(); ++k, ++n) {
      const trajectory::Pose is = *flown.pose_at(c.time[k]), truth = *exact.pose_at(c.time[k]);
      const Eigen::Matrix3d ned = ecef_R_ned_at(truth);
      const Vector3d shift = ned.transpose() * (truth.position - is.position);
      const core::Attitude x = core::attitude_of(ned.transpose() * is.ecef_R_body),
                           y = core::attitude_of(ned.transpose() * truth.ecef_R_body);
      const double error[6] = {shift.x(),       shift.y(),         shift.z(),
                               y.roll - x.roll, y.pitch - x.pitch, std::remainder(y.heading - x.heading, 2.0 * core::pi)};
      for (size_t i = 0; i < 6; ++i) out[i] += std::pow((error[i] - c.value[k][i]) / c.sigma[k][i], 2);
    }
  for (double& v : out) v /= n;
  return out;
}

// More knots than may all be correlated with all are chained: the same values and sigmas, as true as those of a few.
TEST(Adjust, ManyKnotsGiveTheSameAsAFew) {
  const World w =
      pattern_of({{0.0, 0.0}, {180.0 * deg, 0.0}, {90.0 * deg, 0.0}, {270.0 * deg, 0.0}, {0.0, 230.0}, {180.0 * deg, 230.0}}, 10, 8);
  constexpr int flights = 5;
  const ErrorDraw draw(w, tactical_errors, 1.0);
  const trajectory::Trajectory exact(w.exact);
  AdjustOptions few = plain(), many = plain();
  few.corrections.spacing.value = 1.0;
  many.corrections.spacing.value = 0.2;
  for (const ErrorShape shape : {ErrorShape::known, ErrorShape::guessed}) {
    std::array<double, 6> of_few{}, of_many{};
    for (int s = 0; s < flights; ++s) {
      Dice dice(static_cast<std::uint64_t>(7000 + s));
      const TieSet ties = ties_of(w, &dice, static_cast<std::uint64_t>(s));
      const trajectory::Trajectory t(draw.with_errors(w.exact, dice));
      const auto run = [&](const AdjustOptions& o) {
        return adjust(ties, w.scanner, near_truth(w), w.noise, t, tactical_errors, o, 1, shape);
      };
      const Adjustment a = run(few), b = run(many);
      EXPECT_TRUE(b.converged) << s << " after " << b.iterations;
      EXPECT_EQ(b.knot_spacing, 0.2);
      EXPECT_GT(b.unknowns, 3600u);
      for (const Parameter p : usual) {
        const Estimate &x = a.estimates[p], &y = b.estimates[p];
        EXPECT_NEAR(y.formal, x.formal, 0.1 * x.formal) << words_of(p).name;
        EXPECT_NEAR(y.found, x.found, 0.4 * x.formal) << words_of(p).name;
      }
      const auto c = squares_of_corrections(a, t, exact), d = squares_of_corrections(b, t, exact);
      for (size_t i = 0; i < 6; ++i) of_few[i] += c[i] / flights, of_many[i] += d[i] / flights;
    }
    for (size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR(std::sqrt(of_many[i]), std::sqrt(of_few[i]), 0.1) << i;
      EXPECT_GT(std::sqrt(of_many[i]), 0.7) << i;  // five flights, all errors of a line alike
      EXPECT_LT(std::sqrt(of_many[i]), 1.5) << i;
    }
  }
}

TEST(Adjust, SigmasAreTrueWithControlAndWithoutCrossLines) {
  AdjustOptions o = plain();
  const MonteCarlo m = fly(pattern_of({{0.0, 0.0}, {180.0 * deg, 0.0}, {0.0, 230.0}, {180.0 * deg, 230.0}}, 8, 6), 40, o, 3);
  for (const Parameter p : usual) {
    EXPECT_GT(m.rms(p), 0.75) << words_of(p).name;  // 40 flights: 11 %
    EXPECT_LT(m.rms(p), 1.25) << words_of(p).name;
  }
}

TEST(Adjust, SigmasAreTrueWhereLittleIsDetermined) {
  // One line, one direction, level ground: what is found and refused is still as uncertain as stated.
  const FlownLine line{0.0, 0.0};
  World level = pattern_of({{0.0, 0.0}, {180.0 * deg, 0.0}, {90.0 * deg, 0.0}}, 0, 6);
  for (TiePlane& p : level.planes) p.normal = Vector3d::UnitZ();
  for (const World& w : {pattern_of({line}, 6, 6), pattern_of({line, line, {0.0, 150.0}}, 6, 6), level}) {
    const MonteCarlo m = fly(w, 40, plain(), 0);
    for (const Parameter p : usual) {
      EXPECT_GT(m.rms(p), 0.65) << words_of(p).name << ", lines " << w.lines.size();  // 40 flights: 11 %; fifteen of them
      EXPECT_LT(m.rms(p), 1.35) << words_of(p).name << ", lines " << w.lines.size();
    }
  }
}

TEST(Adjust, TheStartsSigmaDecidesWhatIsDetermined) {
  // The same flight, of one direction: beside a start known to a degree it determines the pitch, beside one known to 4 arcsec it does not.
  const World w = pattern_of({{0.0, 0.0}, {0.0, 0.0}, {0.0, 50.0}});
  AdjustOptions o = plain();
  EXPECT_TRUE(flown(w, o, 2, w.truth).estimates[boresight_pitch].delivered);
  o.apriori.pitch = core::Radians(4.0 * arcsec);
  const Adjustment a = flown(w, o, 2, w.truth);
  const Estimate& e = a.estimates[boresight_pitch];
  EXPECT_FALSE(e.delivered);
  EXPECT_EQ(e.grade, Grade::undetermined);
  EXPECT_EQ(e.value, e.start);
  EXPECT_EQ(e.sigma, o.apriori.pitch.value);
  EXPECT_NE(e.found, e.start);
  EXPECT_GT(e.found_sigma, 0.0);
}

TEST(Adjust, TwoLinesAreNotJudgedByLeavingOneOut) {
  const World two = pattern_of({{0.0, 0.0}, {180.0 * deg, 60.0}});
  AdjustOptions o = plain();
  o.jackknife.lines = true;
  const Adjustment a = flown(two, o, 9, two.truth);
  const Estimate& e = a.estimates[boresight_roll];
  EXPECT_GT(e.jackknife_lines, 0.0);
  EXPECT_LT(e.sigma, 3.0 * e.formal);
}

TEST(Adjust, ScanOffsetIsTheRollOfAScannerAcross) {
  World w = pattern_of(full_pattern(), 6, 6);
  AdjustOptions o = plain();
  o.estimate.scan_offset = true;
  const Adjustment a = flown(w, o, 3, near_truth(w));
  EXPECT_FALSE(a.estimates[scan_offset].estimated);
  EXPECT_TRUE(a.estimates[boresight_roll].delivered);
  EXPECT_TRUE(says(a, "scan offset and boresight roll are the same turn", true));
}

TEST(Adjust, HeldValuesAreInTheSigma) {
  World w = pattern_of({{0.0, 0.0}, {180.0 * deg, 0.0}, {90.0 * deg, 0.0}, {270.0 * deg, 0.0}}, 8, 8);
  const auto pitch = [&](double lever_arm) {
    w.noise.lever_arm = core::Metres(lever_arm);
    return flown(w, plain(), 3, near_truth(w)).estimates[boresight_pitch];
  };
  const Estimate without = pitch(0.0), with = pitch(0.02);
  EXPECT_EQ(without.held, 0.0);
  EXPECT_EQ(without.sigma, without.formal);
  EXPECT_EQ(with.found, without.found);
  EXPECT_EQ(with.formal, without.formal);
  EXPECT_NEAR(with.held, 0.02 / 700.0, 0.15 * 0.02 / 700.0);  // a lever arm forward looks like pitch from one height
  EXPECT_DOUBLE_EQ(with.sigma, std::hypot(with.formal, with.held));
}

TEST(Adjust, ScanOffsetIsTheHeadingOfACone) {
  World w = pattern_of(full_pattern(), 6, 6);
  TieSet none;
  none.frame = w.frame;
  w.scanner.model = core::ScannerModel::conical;
  AdjustOptions o = plain();
  o.estimate.scan_offset = true;
  const Adjustment a = adjust(none, w.scanner, w.truth, w.noise, trajectory::Trajectory(w.exact), tactical_errors, o);
  EXPECT_FALSE(a.estimates[scan_offset].estimated);
  EXPECT_TRUE(a.estimates[boresight_heading].estimated);
  EXPECT_TRUE(says(a, "scan offset and boresight heading are the same turn", true));
  o.estimate.heading = false;
  EXPECT_TRUE(
      adjust(none, w.scanner, w.truth, w.noise, trajectory::Trajectory(w.exact), tactical_errors, o).estimates[scan_offset].estimated);
}

TEST(Adjust, NothingToAdjust) {
  const World w = pattern_of(full_pattern(), 0);
  TieSet none;
  none.frame = w.frame;
  const Adjustment a = adjust(none, w.scanner, w.truth, w.noise, trajectory::Trajectory(w.exact), tactical_errors, plain());
  EXPECT_TRUE(says(a, "no plane is seen by two lines", true));
  EXPECT_EQ(a.calibration.roll, w.truth.roll);
}

TEST(Adjust, TheSameForAnyNumberOfThreads) {
  const World w = pattern_of(full_pattern(), 6, 6);
  Dice dice(5);
  const TieSet ties = ties_of(w, &dice);
  const trajectory::Trajectory t(w.exact);
  const Adjustment one = adjust(ties, w.scanner, near_truth(w), w.noise, t, tactical_errors, plain(), 1);
  const Adjustment four = adjust(ties, w.scanner, near_truth(w), w.noise, t, tactical_errors, plain(), 4);
  for (const Parameter p : usual) {
    EXPECT_EQ(one.estimates[p].value, four.estimates[p].value);
    EXPECT_EQ(one.estimates[p].sigma, four.estimates[p].sigma);
  }
}

}  // namespace
}  // namespace swath::calib
