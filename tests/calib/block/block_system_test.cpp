// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_system.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include "core/error.h"
#include "tests/calib/block/made_block.h"

namespace swath::calib {
namespace {

test::Making everything() {
  test::Making m;
  m.layout.strips = 2, m.layout.images = 3;
  m.which.drift = DriftSets::strip;
  m.attitudes = true;
  m.camera << 0, 0.1, -0.1, 1e-7, 1e-11, 1e-16, 1e-6, 1e-6, 1e-4, 1e-4;
  m.camera_sigma.setConstant(free_value);
  m.camera_sigma[3] = 1e-6;  // observed
  m.drift = 1.0;
  return m;
}

/// Residuals with one unknown moved by h.
std::vector<double> moved(const ImageBlock& block, const LinearBlock& l, int unknown, double h) {
  ImageBlock b = block;
  BlockSystem system(b, {});  // its priors and its boresight's zero are those of the block that was not moved
  ImageBlock c = block;
  const UnknownNode& n = l.nodes[static_cast<size_t>(l.node_of[static_cast<size_t>(unknown)])];
  const int k = n.components[static_cast<size_t>(unknown - n.first)];
  if (n.kind == NodeKind::image) {
    if (k < 3)
      c.images[n.index].position[k] += h;
    else
      c.images[n.index].camera_R_local = core::exp_so3(h * Eigen::Vector3d::Unit(k - 3)) * c.images[n.index].camera_R_local;
  }
  if (n.kind == NodeKind::camera) c.cameras[n.index].value[k] += h;
  if (n.kind == NodeKind::boresight)
    c.cameras[n.index].body_R_camera = c.cameras[n.index].body_R_camera * core::exp_so3(-h * Eigen::Vector3d::Unit(k));
  if (n.kind == NodeKind::drift) (k < 3 ? c.drifts[n.index].shift[k] : c.drifts[n.index].change[k - 3]) += h;
  return BlockSystem(c, {}).linearise().residual;
}

TEST(BlockSystem, DerivativesAreThoseOfCentralDifferences) {
  for (const DistortionAt at : {DistortionAt::ideal, DistortionAt::measured}) {
    ImageBlock block = test::make_block(everything()).given;
    block.cameras[0].distortion = at;
    block.cameras[0].antenna = {0.5, 0.3, 1.2};
    const LinearBlock l = BlockSystem(block, {}).linearise();
    for (int unknown = 0; unknown < l.unknowns; ++unknown) {
      double scale = 0.0;
      for (size_t k = 0; k < l.column.size(); ++k)
        if (l.column[k] == unknown) scale = std::max(scale, std::abs(l.value[k]));
      ASSERT_GT(scale, 0.0);
      const double h = 1e-3 / scale;  // residuals move by 0.001 sigma
      const auto plus = moved(block, l, unknown, h), minus = moved(block, l, unknown, -h);
      for (const BlockObservation& o : l.observations) {
        if (o.kind == ObservationKind::prior) continue;  // moves with the block's own values in this test
        for (size_t row = o.row; row < o.row + static_cast<size_t>(o.rows); ++row) {
          double analytic = 0.0;
          for (size_t k = l.first[row]; k < l.first[row + 1]; ++k)
            if (l.column[k] == unknown) analytic = l.value[k];
          EXPECT_NEAR((plus[row] - minus[row]) / (2.0 * h) / scale, analytic / scale, 2e-5) << "unknown " << unknown;
        }
      }
    }
  }
}

/// What a thread allocates lies elsewhere than what the first one does, and Ceres sorts by address.
TEST(BlockSystem, ItsPlaceInMemoryChangesNoDigit) {
  const auto solved = [](int pages_from) {
    test::Making m;
    m.attitudes = true;  // with an unknown boresight
    m.camera_sigma.head<4>().setConstant(free_value);
    ImageBlock block = test::make_block(m).given;
    mallopt(M_MMAP_THRESHOLD, pages_from);  // larger pieces are pages of their own: the later, the lower they lie
    EXPECT_TRUE(BlockSystem(block, {}).solve().converged);
    mallopt(M_MMAP_THRESHOLD, 128 * 1024);
    return block;
  };
  const ImageBlock first = solved(128 * 1024);
  for (const int pages_from : {16, 64, 256, 1024}) {
    const ImageBlock other = solved(pages_from);
    for (size_t i = 0; i < first.images.size(); ++i) {
      EXPECT_EQ(other.images[i].position, first.images[i].position) << pages_from;
      EXPECT_EQ(other.images[i].camera_R_local, first.images[i].camera_R_local) << pages_from;
    }
    EXPECT_EQ(other.cameras[0].value, first.cameras[0].value) << pages_from;
  }
}

TEST(BlockSystem, EveryStripHasItsOwnTimeFromItsFirstStation) {
  ImageBlock b = test::make_block(everything()).given;
  find_drift_sets(b);
  ASSERT_EQ(b.drifts.size(), 2u);
  EXPECT_EQ(b.drift_of, (std::vector<int>{0, 0, 0, 1, 1, 1}));
  EXPECT_EQ(b.drifts[1].first, b.images[3].time);
  EXPECT_NEAR(b.drifts[1].span, b.images[5].time - b.images[3].time, 1e-9);
  b.drift_sets = DriftSets::block;
  find_drift_sets(b);
  EXPECT_EQ(b.drifts.size(), 1u);
  b.drift_sets = DriftSets::strip;
  b.images[0].strip = 9;
  EXPECT_THROW(find_drift_sets(b), core::Error);
}

TEST(BlockSystem, APointNeedsTwoRaysOrACoordinateForEachThatIsMissing) {
  ImageBlock b;
  b.images.resize(2);
  b.points.resize(3);
  b.rays = {{0, 0, 0, 0, 1}, {1, 0, 0, 0, 1}, {0, 1, 0, 0, 1}, {0, 2, 0, 0, 1}};
  b.control = {{1, false, {true, true, true}, {}, {}}, {2, true, {true, true, true}, {}, {}}};
  EXPECT_EQ(determined_points(b), (std::vector<char>{1, 1, 0}));  // the check point's coordinates do not count
}

}  // namespace
}  // namespace swath::calib
