// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/adjust_results.h"

#include <gtest/gtest.h>

#include "calib/adjust/parameter_words.h"
#include "tests/calib/adjust_support.h"

namespace swath::calib {
namespace {

using namespace test;
using Eigen::Vector3d;

TEST(AdjustResults, AGoodPatternIsDelivered) {
  World w = pattern_of(full_pattern());
  Dice dice(77);
  for (const size_t k : {size_t{3}, size_t{30}, size_t{35}}) survey(w.planes[k], 0.02, &dice);
  AdjustOptions o = plain();
  o.jackknife = {};
  const Adjustment a = flown(w, o, 5, near_truth(w));
  for (const Parameter p : usual) {
    const Estimate& e = a.estimates[p];
    EXPECT_TRUE(e.estimated && e.delivered) << words_of(p).name;
    EXPECT_LT(std::abs(e.value - value_of(w.truth, p)), 4.0 * e.sigma);
    EXPECT_GE(e.sigma, e.formal);
    EXPECT_GT(e.formal, e.white);
    EXPECT_GT(e.jackknife_lines, 0.0);
    EXPECT_GT(e.jackknife_planes, 0.0);
    EXPECT_GT(e.determined, 0.9);
  }
  EXPECT_FALSE(a.estimates[latency].estimated);
  EXPECT_LT(a.estimates[boresight_roll].sigma, 10.0 * arcsec);
  EXPECT_TRUE(a.findings.empty()) << a.findings[0].what;
  EXPECT_NEAR(a.sigma0, 1.0, 0.1);
  EXPECT_LT(a.condition, 100.0);
  EXPECT_EQ(a.correlation.rows(), 5);
  EXPECT_EQ(a.control.size(), 12u);
  for (const ControlResidual& c : a.control) {
    EXPECT_FALSE(c.rejected);
    EXPECT_LT(std::abs(c.w), 4.0);
  }
  EXPECT_EQ(a.components.size(), 6u);
  EXPECT_GT(a.samples.size(), 1000u);
  EXPECT_LE(a.samples.size(), 20000u);
  ASSERT_EQ(a.corrections.size(), 8u);
  for (const LineCorrection& c : a.corrections)
    for (size_t i = 0; i < c.time.size(); ++i)
      for (size_t k = 0; k < 6; ++k) {
        EXPECT_LE(c.sigma[i][k], 1.001 * c.apriori[i][k]);
        EXPECT_LT(std::abs(c.value[i][k]), 5.0 * c.apriori[i][k]);
      }
  for (size_t k = 0; k < a.planes.size(); ++k) EXPECT_GT(a.plane_sigma[k][0], 0.0);
}

TEST(AdjustResults, ADisplacedFacetAndAWrongControlPointAreLeftOut) {
  World w = pattern_of(full_pattern());
  Dice dice(8);
  for (const size_t k : {size_t{3}, size_t{30}, size_t{35}}) survey(w.planes[k], 0.02, &dice);
  TieSet ties = ties_of(w, &dice);
  const size_t facet = ties.groups.size() / 2;
  for (size_t i = ties.groups[facet].begin; i < ties.groups[facet].end; ++i) ties.returns.range[i] += 0.25;
  ties.planes[30].control[2].point += 0.6 * ties.planes[30].normal;
  const trajectory::Trajectory t(ErrorDraw(w, tactical_errors).with_errors(w.exact, dice));
  const Adjustment a = adjust(ties, w.scanner, near_truth(w), w.noise, t, tactical_errors, plain());
  EXPECT_TRUE(a.groups[facet].rejected);
  EXPECT_GT(std::abs(a.groups[facet].w), 5.0);
  EXPECT_LT(std::count_if(a.groups.begin(), a.groups.end(), [](const GroupResidual& g) { return g.rejected; }),
            static_cast<std::ptrdiff_t>(a.groups.size() / 50));
  EXPECT_TRUE(a.control[6].rejected);
  EXPECT_EQ(std::count_if(a.control.begin(), a.control.end(), [](const ControlResidual& c) { return c.rejected; }), 1);
  for (const Parameter p : usual) EXPECT_LT(std::abs(a.estimates[p].value - value_of(w.truth, p)), 4.0 * a.estimates[p].sigma);
}

// Ackermann's model: position = true + a0 + a1 t in every line, boresight held.
TEST(AdjustResults, ShiftsAndDriftsOfLinesAreFound) {
  World w = pattern_of({{0.0, 0.0}, {180.0 * deg, 200.0}, {0.0, -200.0}, {90.0 * deg, 0.0}}, 14, 12);
  w.noise.roll = w.noise.pitch = w.noise.heading = core::Radians(0.0);  // held at the truth
  w.noise.lever_arm = core::Metres(0.0);
  Dice dice(12);
  for (const size_t k : {size_t{0}, size_t{12}, size_t{24}, size_t{30}, size_t{33}, size_t{36}}) survey(w.planes[k], 0.01, &dice);
  const TieSet ties = ties_of(w, &dice);
  std::vector<std::array<Vector3d, 2>> drift;
  for (size_t l = 0; l < w.lines.size(); ++l) drift.push_back({0.08 * dice.vector(), 0.004 * dice.vector()});
  const trajectory::Trajectory t(ErrorDraw::add(w.exact, [&](double at) {
    size_t l = 0;
    while (l + 1 < w.lines.size() && at > w.first(l + 1) - 0.5 * w.pause) ++l;
    Correction e = Correction::Zero();
    e.head<3>() = drift[l][0] + drift[l][1] * (at - w.first(l) - 10.0);
    return e;
  }));
  AdjustOptions o = plain();
  o.estimate = {false, false, false, false, false, false, false, false, false, false, false};
  o.corrections.position = CorrectionForm::drift;
  o.corrections.attitude = CorrectionForm::none;
  o.corrections.prior = CorrectionPrior::stated;
  const Adjustment a = adjust(ties, w.scanner, w.truth, w.noise, t, tactical_errors, o);
  double squares = 0.0, standard = 0.0, n = 0.0;
  for (size_t l = 0; l < w.lines.size(); ++l) {
    ASSERT_EQ(a.corrections[l].time.size(), 2u);
    for (size_t i = 0; i < 2; ++i)
      for (int c = 0; c < 3; ++c) {
        const double truth = -(drift[l][0][c] + drift[l][1][c] * (a.corrections[l].time[i] - w.first(l) - 10.0));
        const double e = a.corrections[l].value[i][c] - truth;
        squares += e * e;
        standard += e * e / std::pow(a.corrections[l].sigma[i][c], 2);
        n += 1.0;
      }
  }
  EXPECT_LT(std::sqrt(squares / n), 0.03);         // of 8 cm and 4 mm/s; along the lines it hangs on a few slopes
  EXPECT_NEAR(std::sqrt(standard / n), 1.0, 0.4);  // 24 values, hardly independent
  double before = 0.0, after = 0.0;
  for (const GroupResidual& g : a.groups) before += g.before * g.before, after += g.after * g.after;
  EXPECT_LT(after, 0.05 * before);
}

}  // namespace
}  // namespace swath::calib
