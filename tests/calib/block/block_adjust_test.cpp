// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_adjust.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "core/error.h"
#include "io/text/value_file.h"
#include "tests/calib/block/made_block.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

BlockOptions plain_least_squares() {
  BlockOptions o;
  o.robust = o.components = false;
  return o;
}

Vector3d vector_of(const core::Value& v, size_t first = 0) {
  return {v.items()[first].as_number(), v.items()[first + 1].as_number(), v.items()[first + 2].as_number()};
}

/// The reference block as a user has it: stations, image points, control; poses start from the strips' directions.
ImageBlock small_block(const core::Value& v, DriftSets drift) {
  ImageBlock b;
  b.drift_sets = drift;
  BlockCamera camera;
  camera.value[0] = 150.0;
  camera.body_R_camera << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  b.cameras.push_back(camera);
  const auto& gps = v.find("gps")->items();
  for (std::uint32_t i = 0; i < gps.size(); ++i) {
    BlockImage image;
    image.name = std::to_string(i);
    image.strip = static_cast<int>(v.find("strip")->items()[i].as_int());
    image.time = v.find("t")->items()[i].as_number();
    b.images.push_back(image);
    b.stations.push_back({i, vector_of(gps[i]), 0.09 * Eigen::Matrix3d::Identity()});
  }
  for (size_t p = 0; p < v.find("true_points")->items().size(); ++p) b.points.push_back({std::to_string(p), Vector3d::Zero()});
  for (const core::Value& o : v.find("observations_photo_point_x_y_mm")->items())
    b.rays.push_back({static_cast<std::uint32_t>(o.items()[0].as_int()), static_cast<std::uint32_t>(o.items()[1].as_int()),
                      o.items()[2].as_number(), o.items()[3].as_number(), 0.01});
  for (const core::Value& c : v.find("control")->items()) {
    const bool plan = c.find("type")->as_text() == "XYZ";
    b.control.push_back({static_cast<std::uint32_t>(c.find("point")->as_int()),
                         false,
                         {plan, plan, true},
                         {c.find("X")->as_number(), c.find("Y")->as_number(), c.find("Z")->as_number()},
                         Vector3d::Constant(0.3)});
  }
  start_poses(b);
  intersect_points(b);
  return b;
}

void expect_block(const core::Value& v, const char* name, DriftSets drift) {
  SCOPED_TRACE(name);
  ImageBlock b = small_block(v, drift);
  const BlockSolution s = adjust_block(b, plain_least_squares());
  const core::Value& e = *v.find("expected")->find(name);
  EXPECT_EQ(s.observations, static_cast<size_t>(e.find("nobs")->as_int()));
  EXPECT_EQ(s.unknowns, static_cast<size_t>(e.find("unknowns")->as_int()));
  EXPECT_NEAR(s.square_sum, e.find("vtpv")->as_number(), 1e-5);
  EXPECT_NEAR(s.sigma0(), e.find("sigma0_ratio")->as_number(), 1e-7);
  constexpr double millimetre = 1e-3, angle = 1e-8, share = 0.005;  // stated with the vector
  for (size_t p = 0; p < b.points.size(); ++p) {
    const Vector3d difference = b.points[p].position - vector_of(e.find("points")->items()[p]);
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), millimetre) << "point " << p;
    const Vector3d sd = vector_of(e.find("sd_points")->items()[p]);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::sqrt(s.inference.points[p](k, k)), sd[k], share * sd[k]) << "point " << p;
  }
  for (size_t i = 0; i < b.images.size(); ++i) {
    const core::Value& eo = e.find("eo")->items()[i];
    EXPECT_LT((b.images[i].position - vector_of(eo)).cwiseAbs().maxCoeff(), millimetre);
    const Eigen::Matrix3d& R = b.images[i].camera_R_local;  // Rkappa Rphi Romega
    const Vector3d found(std::atan2(-R(2, 1), R(2, 2)), std::asin(R(2, 0)), std::atan2(-R(1, 0), R(0, 0)));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(core::wrap_pi(found[k] - vector_of(eo, 3)[k]), 0.0, angle) << "image " << i;
  }
  const auto& drifts = e.find("drift")->items();
  ASSERT_EQ(b.drifts.size(), drifts.size());
  for (size_t d = 0; d < drifts.size(); ++d)
    for (size_t k = 0; k < 3; ++k) {
      // The vector counts time from the middle of the set, in spans.
      const double shift = drifts[d].items()[k].items()[0].as_number(), slope = drifts[d].items()[k].items()[1].as_number();
      EXPECT_NEAR(b.drifts[d].change[static_cast<int>(k)], slope, millimetre);
      double mean = 0.0, n = 0.0;
      for (const ImageStation& station : b.stations)
        if (drift == DriftSets::block || b.images[station.image].strip == b.drifts[d].strip) {
          mean += (b.images[station.image].time - b.drifts[d].first) / b.drifts[d].span;
          n += 1.0;
        }
      EXPECT_NEAR(b.drifts[d].shift[static_cast<int>(k)] + mean / n * b.drifts[d].change[static_cast<int>(k)], shift, millimetre);
    }
}

TEST(BlockAdjust, TheSmallBlockOfThePaper) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p002_small_block.json");
  const core::Value v = io::read_value_file(file);
  expect_block(v, "none", DriftSets::none);
  expect_block(v, "block", DriftSets::block);
  expect_block(v, "strip", DriftSets::strip);
}

/// Sum of squared errors in sigmas, and their number.
struct Nees {
  double sum = 0.0, n = 0.0;
  void add(double error, double variance) { sum += error * error / variance, n += 1.0; }
  double ratio() const { return std::sqrt(sum / n); }
};

/// Errors over sigmas of all that is adjusted.
struct AllNees {
  Nees points, positions, attitudes, camera, shifts, boresight;
  void add(const test::MadeBlock& b, const BlockSolution& s);
  std::vector<std::pair<const char*, double>> ratios() const {
    std::vector<std::pair<const char*, double>> out{{"points", points.ratio()},
                                                    {"positions", positions.ratio()},
                                                    {"attitudes", attitudes.ratio()},
                                                    {"camera", camera.ratio()},
                                                    {"boresight", boresight.ratio()}};
    if (shifts.n > 0.0) out.emplace_back("shifts", shifts.ratio());
    return out;
  }
};

void AllNees::add(const test::MadeBlock& b, const BlockSolution& s) {
  for (size_t p = 0; p < b.given.points.size(); ++p)
    for (int k = 0; k < 3; ++k) points.add(b.given.points[p].position[k] - b.truth.points[p].position[k], s.inference.points[p](k, k));
  for (size_t n = 0; n < s.linear.nodes.size(); ++n) {
    const UnknownNode& node = s.linear.nodes[n];
    const Eigen::MatrixXd& C = s.inference.nodes[n];
    if (node.kind == NodeKind::image) {
      const Vector3d dX = b.given.images[node.index].position - b.truth.images[node.index].position;
      const Vector3d turn =
          core::log_so3(b.given.images[node.index].camera_R_local * b.truth.images[node.index].camera_R_local.transpose());
      for (int k = 0; k < 3; ++k) positions.add(dX[k], C(k, k)), attitudes.add(turn[k], C(3 + k, 3 + k));
    }
    if (node.kind == NodeKind::camera)
      for (size_t k = 0; k < node.components.size(); ++k) {
        const auto i = static_cast<Eigen::Index>(k);
        camera.add(b.given.cameras[0].value[node.components[k]] - b.truth.cameras[0].value[node.components[k]], C(i, i));
      }
    if (node.kind == NodeKind::boresight) {
      const Vector3d turn = core::log_so3(b.given.cameras[0].body_R_camera.transpose() * b.truth.cameras[0].body_R_camera);
      for (int k = 0; k < 3; ++k) boresight.add(turn[k], C(k, k));
    }
    if (node.kind == NodeKind::drift)
      for (int k = 0; k < 3; ++k) {
        shifts.add(b.given.drifts[node.index].shift[k] - b.truth.drifts[node.index].shift[k], C(k, k));
        shifts.add(b.given.drifts[node.index].change[k] - b.truth.drifts[node.index].change[k], C(3 + k, 3 + k));
      }
  }
}

test::Making flight(unsigned seed, DriftSets drift) {
  test::Making m;
  m.seed = seed;
  m.layout.strips = 3, m.layout.images = 7, m.layout.side = 0.4;
  m.which = {"", drift, ControlLayout::corners, 2};
  m.drift = 1.5;
  m.attitudes = true;
  m.camera << 0, 0.05, -0.08, 2e-8, 0, 0, 0, 0, 0, 0;
  m.camera_sigma.head<4>().setConstant(free_value);
  return m;
}

TEST(BlockAdjust, SigmasAreTrueOverSeeds) {
  AllNees all;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    test::MadeBlock b = test::make_block(flight(seed, DriftSets::strip));
    const BlockSolution s = adjust_block(b.given, plain_least_squares());
    all.add(b, s);
  }
  // 80 camera values, 60 of the boresight, all correlated within a seed: 0.85-1.15 is two of their own sigmas.
  for (const auto& [name, ratio] : all.ratios()) {
    EXPECT_GT(ratio, 0.85) << name;
    EXPECT_LT(ratio, 1.15) << name;
  }
}

/// As the stations of a made block are: each error a share of the one before.
std::vector<NavigationStep> chain_of(const ImageBlock& b, double share) {
  std::vector<NavigationStep> out;
  for (std::uint32_t i = 0; i < b.images.size(); ++i) {
    NavigationStep step;
    step.image = i;
    if (i > 0) step.before = {i - 1}, step.by_before = share * Eigen::MatrixXd::Identity(6, 6);
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(6, 6);
    C.topLeftCorner(3, 3) = b.stations[i].covariance, C.bottomRightCorner(3, 3) = b.attitudes[i].covariance;
    step.root = (i > 0 ? std::sqrt(1.0 - share * share) : 1.0) * Eigen::MatrixXd(C.diagonal().cwiseSqrt().asDiagonal());
    out.push_back(step);
  }
  return out;
}

/// Errors of stations and attitudes that are correlated from image to image: with the chain sigmas are true, without it they are too small.
TEST(BlockAdjust, CorrelatedStationsHaveTrueSigmasWithTheirChain) {
  constexpr double share = 0.95;
  AllNees with, without;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    test::Making m = flight(seed, DriftSets::none);
    m.correlation = share;
    m.layout.sigma_image = core::Metres(5e-6);
    m.layout.sigma_station = m.layout.sigma_control = core::Metres(0.3);
    test::MadeBlock b = test::make_block(m), plain = b;
    ASSERT_EQ(b.given.stations.size(), b.given.images.size());
    b.given.chain = chain_of(b.given, share);
    const BlockSolution s = adjust_block(b.given, plain_least_squares());
    EXPECT_NEAR(s.sigma0(), 1.0, 0.15);
    with.add(b, s);
    without.add(plain, adjust_block(plain.given, plain_least_squares()));
  }
  for (const auto& [name, ratio] : with.ratios()) {
    EXPECT_GT(ratio, 0.85) << name;
    EXPECT_LT(ratio, 1.15) << name;
  }
  for (const auto& [name, ratio] : with.ratios()) std::printf("with the chain: %s %.3f\n", name, ratio);
  for (const auto& [name, ratio] : without.ratios()) std::printf("without the chain: %s %.2f\n", name, ratio);
  EXPECT_GT(without.positions.ratio(), 1.25);
  EXPECT_GT(without.boresight.ratio(), 1.25);
}

/// Stations and attitudes of another datum than control: its values over their sigmas, and the block in the datum of control.
TEST(BlockAdjust, DatumsHaveTrueSigmas) {
  for (const Datum datum : {Datum::shift, Datum::similarity}) {
    AllNees all;
    Nees shift, rotation, scale;
    for (unsigned seed = 1; seed <= 20; ++seed) {
      test::Making m = flight(seed, DriftSets::none);
      m.which.control = ControlLayout::chains;
      m.datum = datum;
      m.stations.shift = {-1.7, 2.1, 45.3};
      if (datum == Datum::similarity) m.stations.rotation = {1e-5, -2e-5, 3e-5}, m.stations.scale = 8e-6;
      test::MadeBlock b = test::make_block(m);
      const BlockSolution s = adjust_block(b.given, plain_least_squares());
      all.add(b, s);
      const UnknownNode* node = nullptr;
      Eigen::MatrixXd C;
      for (size_t n = 0; n < s.linear.nodes.size(); ++n)
        if (s.linear.nodes[n].kind == NodeKind::datum) node = &s.linear.nodes[n], C = s.inference.nodes[n];
      ASSERT_NE(node, nullptr);
      ASSERT_EQ(node->components.size(), datum == Datum::shift ? 3u : 7u);
      const StationDatum& found = b.given.station_datum;
      // The true shift is that in the middle of the true stations; here it is in the middle of those observed.
      const Vector3d apart = found.centre - m.stations.shift - b.truth_centre;
      const Vector3d at_found = (1.0 + m.stations.scale) * core::exp_so3(m.stations.rotation) * (found.centre - b.truth_centre) +
                                b.truth_centre + m.stations.shift - found.centre;
      EXPECT_LT(apart.norm(), 1.0);
      for (int k = 0; k < 3; ++k) shift.add(found.shift[k] - at_found[k], C(k, k));
      if (datum == Datum::shift) continue;
      for (int k = 0; k < 3; ++k) rotation.add(found.rotation[k] - m.stations.rotation[k], C(3 + k, 3 + k));
      scale.add(found.scale - m.stations.scale, C(6, 6));
    }
    std::vector<std::pair<const char*, double>> ratios = all.ratios();
    ratios.emplace_back("shift", shift.ratio());
    if (datum == Datum::similarity) ratios.emplace_back("rotation", rotation.ratio());
    for (const auto& [name, ratio] : ratios) {
      EXPECT_GT(ratio, 0.85) << name;
      EXPECT_LT(ratio, 1.15) << name;
    }
    if (datum == Datum::similarity) {  // of 20 values: 0.16 is a sigma of the ratio
      EXPECT_GT(scale.ratio(), 0.6);
      EXPECT_LT(scale.ratio(), 1.4);
    }
  }
}

TEST(BlockAdjust, ADatumThatControlDoesNotDetermineIsNamed) {
  const auto fault_with = [](Datum datum, const std::function<void(ImageBlock&)>& change) -> std::string {
    test::Making m = flight(1, DriftSets::none);
    m.datum = datum;
    test::MadeBlock b = test::make_block(m);
    change(b.given);
    try {
      adjust_block(b.given, plain_least_squares());
    } catch (const core::Error& e) {
      return std::string(e.what()) + "; " + e.hint();
    }
    return "";
  };
  const auto without_control = [](ImageBlock& b) { b.control.clear(); };
  EXPECT_NE(
      fault_with(Datum::shift, without_control).find("the datum of the stations is not determined by control; survey a control point"),
      std::string::npos);
  const auto few = [](ImageBlock& b) { b.control.resize(2); };  // rotation about their line
  EXPECT_EQ(fault_with(Datum::shift, few), "");
  EXPECT_NE(fault_with(Datum::similarity, few).find("the datum of the stations is not determined by control; survey three"),
            std::string::npos);
}

TEST(BlockAdjust, GrossErrorsLoseTheirWeightAndTheTestFindsThem) {
  test::Making m;
  m.layout.side = 0.4;
  test::MadeBlock b = test::make_block(m);
  // Two rays of different points that several images see: an error across the only two rays of a point could not be seen.
  std::vector<int> count(b.given.points.size(), 0);
  for (const ImageRay& r : b.given.rays) ++count[r.point];
  std::vector<std::uint32_t> wrong;
  for (std::uint32_t r = 0; r < b.given.rays.size() && wrong.size() < 2; ++r)
    if (count[b.given.rays[r].point] >= 6 && (wrong.empty() || b.given.rays[r].image > b.given.rays[wrong[0]].image + 2))
      wrong.push_back(r);
  ASSERT_EQ(wrong.size(), 2u);
  b.given.rays[wrong[0]].x += 0.4;  // 40 sigma
  b.given.rays[wrong[1]].y -= 0.3;
  ImageBlock plain = b.given;
  const BlockSolution tested = adjust_block(plain, plain_least_squares());
  float largest = 0.0f;
  std::uint32_t at = 0;
  for (const BlockObservation& o : tested.linear.observations)
    for (size_t row = o.row; row < o.row + static_cast<size_t>(o.rows); ++row)
      if (std::abs(tested.inference.w[row]) > largest)
        largest = std::abs(tested.inference.w[row]), at = o.kind == ObservationKind::ray ? o.index : 0;
  EXPECT_EQ(at, wrong[0]);
  BlockOptions robust;
  robust.components = false;
  const BlockSolution s = adjust_block(b.given, robust);
  EXPECT_LT(s.weights.of_ray[wrong[0]], 1e-5);
  EXPECT_LT(s.weights.of_ray[wrong[1]], 1e-5);
  EXPECT_LE(s.without_weight, 4u);
  for (size_t p = 0; p < b.given.points.size(); ++p)
    for (int k = 0; k < 3; ++k)
      EXPECT_LT(std::abs(b.given.points[p].position[k] - b.truth.points[p].position[k]), 5.0 * std::sqrt(s.inference.points[p](k, k)));
}

TEST(BlockAdjust, ComponentsFindTheSigmas) {
  test::Making m;
  m.layout.strips = 4, m.layout.images = 10;
  m.layout.sigma_image = core::Metres(3e-6);  // 9 cm on the ground: images check stations
  m.layout.sigma_station = m.layout.sigma_control = core::Metres(0.3);
  test::MadeBlock b = test::make_block(m);
  for (ImageRay& r : b.given.rays) r.sigma *= 2.0;               // twice too large
  for (ImageStation& s : b.given.stations) s.covariance /= 9.0;  // three times too small
  BlockOptions o;
  const BlockSolution s = adjust_block(b.given, o);
  EXPECT_NEAR(s.weights.ray, 0.5, 0.05);
  EXPECT_NEAR(s.weights.station, 3.0, 0.6);  // 120 coordinates less what the block takes: 10 % each
  EXPECT_NEAR(s.sigma0(), 1.0, 0.05);
}

/// Gross errors that have lost their weight say nothing of the others' sigma, neither by their residuals nor by their redundancy.
TEST(BlockAdjust, ImagePointsWithoutWeightDoNotMakeSigmasSmaller) {
  test::Making m;
  m.layout.strips = 4, m.layout.images = 12, m.layout.side = 0.6;
  test::MadeBlock b = test::make_block(m);
  for (std::uint32_t r = 3; r < b.given.rays.size(); r += 10) b.given.rays[r].x += r % 20 == 3 ? 1.0 : -1.0;  // 100 sigma
  BlockOptions o;
  const BlockSolution s = adjust_block(b.given, o);
  EXPECT_GE(s.without_weight, b.given.rays.size() / 10);
  std::printf("%zu of %zu without weight, factor %.4f, redundancy %.1f and %.1f lost\n", s.without_weight, b.given.rays.size(),
              s.weights.ray, s.inference.redundancy_of[0], s.inference.redundancy_lost);
  const double own = 1.0 / std::sqrt(2.0 * s.inference.redundancy_of[0]);  // sigma of the factor
  EXPECT_NEAR(s.weights.ray, 1.0, 3.0 * own);
  EXPECT_NEAR(s.sigma0(), 1.0, 3.0 * own);
}

TEST(BlockAdjust, ARayThatYieldsDoesNotMakeTheOthersABlunder) {
  // Normal errors: 2000 image points of 20 blocks, whose largest residual has about 4 sigmas and keeps most of its weight.
  for (unsigned seed = 1; seed <= 20; ++seed) {
    test::Making m;
    m.seed = seed;
    test::MadeBlock b = test::make_block(m);
    const BlockSolution s = adjust_block(b.given, {});
    EXPECT_EQ(s.without_weight, 0u) << seed;
    EXPECT_GT(*std::min_element(s.weights.of_ray.begin(), s.weights.of_ray.end()), 0.4) << seed;
  }
}

TEST(BlockAdjust, WhatIsMissingIsNamed) {
  test::MadeBlock b = test::make_block({});
  b.given.images[3].name = "P4";
  std::vector<ImageRay> kept;
  for (const ImageRay& r : b.given.rays)
    if (r.image != 3) kept.push_back(r);
  b.given.rays = kept;
  try {
    adjust_block(b.given, plain_least_squares());
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("image P4 has 0 image points"), std::string::npos) << e.what();
  }
  ImageBlock none;
  EXPECT_THROW(adjust_block(none, {}), core::Error);
}

}  // namespace
}  // namespace swath::calib
