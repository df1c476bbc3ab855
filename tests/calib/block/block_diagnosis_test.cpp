// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_diagnosis.h"

#include <gtest/gtest.h>

#include "calib/block/block_inference.h"
#include "core/error.h"
#include "tests/calib/block/made_block.h"

namespace swath::calib {
namespace {

/// Error and hint of a block that must not be solved.
std::string refusal(ImageBlock& block) {
  const LinearBlock l = BlockSystem(block, {}).linearise();
  const BlockInference found = infer(l);
  EXPECT_FALSE(found.determined() && found.unsound_points.empty());
  try {
    refuse_undetermined(block, l, found.unsound_points);
  } catch (const core::Error& e) {
    return e.text();
  }
}

ImageBlock block_of(DriftSets drift, ControlLayout control, int strips = 4) {
  TheoryOptions o;
  o.strips = strips, o.images = 7;
  return theoretical_block(o, {"", drift, control, 0});
}

TEST(BlockDiagnosis, FourCornersWithStripDriftNameCrossStripsAndHeightChains) {
  ImageBlock b = block_of(DriftSets::strip, ControlLayout::corners);
  const std::string text = refusal(b);
  EXPECT_NE(text.find("leave heights of the points undetermined"), std::string::npos) << text;
  EXPECT_NE(text.find("cross strips"), std::string::npos) << text;
  EXPECT_NE(text.find("chains of height control"), std::string::npos) << text;
}

TEST(BlockDiagnosis, BlockDriftWithoutControlAsksForControl) {
  ImageBlock b = block_of(DriftSets::block, ControlLayout::none);
  const std::string text = refusal(b);
  EXPECT_NE(text.find("heights and plan of the points"), std::string::npos) << text;
  EXPECT_NE(text.find("control points"), std::string::npos) << text;
}

TEST(BlockDiagnosis, ABlockWithoutStationsAndControlHasNoDatum) {
  ImageBlock b = block_of(DriftSets::none, ControlLayout::none);
  b.stations.clear();
  find_drift_sets(b);
  EXPECT_NE(refusal(b).find("position, scale or attitude of the whole block"), std::string::npos);
}

TEST(BlockDiagnosis, OneStripWithStationsAloneTurnsAboutItself) {
  ImageBlock b = block_of(DriftSets::none, ControlLayout::none, 1);
  EXPECT_NE(refusal(b).find("not determined"), std::string::npos);
}

TEST(BlockDiagnosis, AnImageWithTwoPointsIsNamed) {
  ImageBlock b = block_of(DriftSets::none, ControlLayout::chains);
  b.images[5].name = "lonely";
  std::vector<ImageRay> kept;
  int left = 1;
  for (const ImageRay& r : b.rays)
    if (r.image != 5 || left-- > 0) kept.push_back(r);
  b.rays = kept;
  EXPECT_NE(refusal(b).find("image lonely"), std::string::npos);
}

TEST(BlockDiagnosis, AValueThatNothingSeparatesIsNamed) {
  // Vertical images over level ground at one height, heights from control alone: f is not separated from the flying height.
  ImageBlock b = block_of(DriftSets::none, ControlLayout::chains);
  b.stations.clear();
  find_drift_sets(b);
  b.cameras[0].sigma[0] = free_value;
  const std::string text = refusal(b);
  EXPECT_NE(text.find("camera.f"), std::string::npos) << text;
}

TEST(BlockDiagnosis, ADeterminedBlockHasNoModes) {
  ImageBlock b = block_of(DriftSets::strip, ControlLayout::chains);
  EXPECT_TRUE(undetermined_modes(b, BlockSystem(b, {}).linearise()).empty());
}

}  // namespace
}  // namespace swath::calib
