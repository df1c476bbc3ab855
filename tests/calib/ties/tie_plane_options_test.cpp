// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/tie_plane_options.h"

#include <gtest/gtest.h>

namespace swath::calib {
namespace {

core::SensorSigma two_centimetres() {
  core::SensorSigma s;
  s.range = core::Metres(0.02);
  s.beam_divergence = core::Radians(0.5e-3);
  return s;
}

TEST(TiePlaneOptions, AnAircraftsSizes) {
  for (const FlownScale& scale : {FlownScale{}, scale_of(700.0, 4.0, two_centimetres())}) {
    const TiePlaneOptions o = sized({}, scale);
    EXPECT_EQ(o.piece->value, 12.0);
    EXPECT_EQ(o.extent->value, 1.5);
    EXPECT_EQ(o.roughness->value, 0.08);
    EXPECT_EQ(o.margin->value, 0.4);
  }
  EXPECT_FALSE(sized({}, {}).cell);
  EXPECT_NEAR(sized({}, scale_of(700.0, 4.0, two_centimetres())).cell->value, std::sqrt(10.0 / 4.0), 1e-12);
  EXPECT_EQ(sized({}, scale_of(700.0, 100.0, two_centimetres())).cell->value, 1.5);
  EXPECT_EQ(sized({}, scale_of(700.0, 0.1, two_centimetres())).cell->value, 5.0);
}

TEST(TiePlaneOptions, MorePlanesForLongerLines) {
  FlownScale scale = scale_of(700.0, 4.0, two_centimetres());
  EXPECT_EQ(*sized({}, scale).planes, 1200);
  scale.seconds = 500.0;
  EXPECT_EQ(*sized({}, scale).planes, 1200);
  scale.seconds = 10000.0;
  EXPECT_EQ(*sized({}, scale).planes, 20000);
  scale.seconds = 1e9;
  EXPECT_EQ(*sized({}, scale).planes, 100000);
  TiePlaneOptions stated;
  stated.planes = 300;
  EXPECT_EQ(*sized(stated, scale).planes, 300);
}

TEST(TiePlaneOptions, ASmallOnesAt40Metres) {
  const TiePlaneOptions o = sized({}, scale_of(40.0, 200.0, two_centimetres()));
  EXPECT_EQ(o.piece->value, 4.0);
  EXPECT_EQ(o.extent->value, 0.5);
  EXPECT_NEAR(o.roughness->value, 2.5 * std::hypot(0.02, 0.005),
              1e-9);  // two and a half times the noise, which is more than the piece would have
  EXPECT_EQ(o.margin->value, 0.1);
  EXPECT_EQ(o.cell->value, 0.25);
  core::SensorSigma fine = two_centimetres();
  fine.range = core::Metres(0.005);
  EXPECT_LT(sized({}, scale_of(40.0, 200.0, fine)).roughness->value, o.roughness->value);
}

TEST(TiePlaneOptions, SizesGrowWithTheHeight) {
  TiePlaneOptions last = sized({}, scale_of(20.0, 50.0, two_centimetres()));
  for (double height = 40.0; height < 1000.0; height *= 1.5) {
    const TiePlaneOptions o = sized({}, scale_of(height, 50.0, two_centimetres()));
    EXPECT_GE(o.piece->value, last.piece->value);
    EXPECT_GE(o.extent->value, last.extent->value);
    EXPECT_GE(o.roughness->value, last.roughness->value);
    EXPECT_GE(o.margin->value, last.margin->value);
    EXPECT_GE(o.cell->value, last.cell->value);
    last = o;
  }
}

TEST(TiePlaneOptions, WhatIsStatedStays) {
  TiePlaneOptions o;
  o.piece = core::Metres(9.0);
  o.roughness = core::Metres(0.2);
  o.cell = core::Metres(0.7);
  const TiePlaneOptions with = sized(o, scale_of(40.0, 200.0, two_centimetres()));
  EXPECT_EQ(with.piece->value, 9.0);
  EXPECT_EQ(with.extent->value, 9.0 / 8.0);
  EXPECT_EQ(with.roughness->value, 0.2);
  EXPECT_EQ(with.cell->value, 0.7);
}

TEST(TiePlaneOptions, UnknownIsNotANumber) {
  const FlownScale s = scale_of(std::nan(""), std::nan(""), two_centimetres());
  EXPECT_EQ(s.height, 0.0);
  EXPECT_EQ(s.density, 0.0);
}

}  // namespace
}  // namespace swath::calib
