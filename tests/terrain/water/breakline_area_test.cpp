// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/water/breakline_area.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace swath::terrain {
namespace {

using core::Area;
using core::Box;
using core::Breakline;
using core::BreaklineKind;
using Eigen::Vector3d;

const Vector3d origin(500000.0, 5400000.0, 0.0);
const Area area{{-30000, -30000, 30000, 30000}, -12e3, 20e3};
constexpr const char* vertices = "breakline vertices outside the survey's area, left out";

std::vector<Breakline> kept(const Breakline& b, core::Tally& tally) {
  std::vector<Breakline> all{b};
  keep_in_area(all, area, origin, tally);
  return all;
}

TEST(BreaklineArea, LinesAndAreasWithinStayAsTheyAre) {
  core::Tally tally;
  const std::vector<Vector3d> v{{0, 0, 300}, {100, 0, 301}, {100, 100, 302}};
  for (const BreaklineKind kind : {BreaklineKind::breakline, BreaklineKind::lake, BreaklineKind::boundary}) {
    const auto out = kept({kind, "f", {v}}, tally);
    ASSERT_EQ(out.size(), 1u);
    EXPECT_EQ(out[0].parts, std::vector<std::vector<Vector3d>>{v});
  }
  EXPECT_TRUE(tally.empty());
}

TEST(BreaklineArea, ALineIsDividedAtAWildVertex) {
  for (const Vector3d& wild : {Vector3d(1e6, 0, 300), Vector3d(1e300, 0, 300), Vector3d(50, std::nan(""), 300), Vector3d(50, 0, 1e6)}) {
    core::Tally tally;
    const auto out = kept({BreaklineKind::breakline, "f", {{{0, 0, 1}, {10, 0, 1}, wild, {20, 0, 1}, {30, 0, 1}, {40, 0, 1}}}}, tally);
    ASSERT_EQ(out.size(), 2u);
    EXPECT_EQ(out[0].parts[0].size(), 2u);
    EXPECT_EQ(out[1].parts[0].size(), 3u);
    EXPECT_EQ(tally.of(vertices), 1u);
  }
}

TEST(BreaklineArea, ASingleWildVertexLeavesAnArea) {
  core::Tally tally;
  const auto out = kept({BreaklineKind::lake, "f", {{{0, 0, 1}, {100, 0, 1}, {1e9, 1e9, 1}, {0, 100, 1}}}}, tally);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].parts[0].size(), 3u);
  EXPECT_EQ(tally.of(vertices), 1u);
}

TEST(BreaklineArea, AWideAreaIsCutAtTheBorder) {
  core::Tally tally;
  const auto out = kept({BreaklineKind::boundary, "f", {{{-1e6, -1e6, 0}, {1e6, -1e6, 0}, {1e6, 0, 0}, {-1e6, 0, 0}}}, false}, tally);
  ASSERT_EQ(out.size(), 1u);
  double twice_area = 0;
  const auto& ring = out[0].parts[0];
  for (size_t k = 0; k < ring.size(); ++k) {
    const Vector3d &p = ring[k], &q = ring[(k + 1) % ring.size()];
    twice_area += p.x() * q.y() - q.x() * p.y();
    EXPECT_LE(p.cwiseAbs().maxCoeff(), 30000.0);
  }
  EXPECT_DOUBLE_EQ(0.5 * twice_area, 60000.0 * 30000.0);
  EXPECT_EQ(tally.of(vertices), 0u);
}

TEST(BreaklineArea, AnAreaThatLosesMoreThanAFewVerticesIsRefused) {
  core::Tally tally;
  const Vector3d nan(std::nan(""), 0, 1), far(1e9, 1e9, 1);
  EXPECT_THROW(kept({BreaklineKind::lake, "f", {{{0, 0, 1}, nan, {100, 0, 1}, nan, {100, 100, 1}, {0, 100, 1}}}}, tally), core::Error);
  EXPECT_THROW(kept({BreaklineKind::lake, "f", {{{0, 0, 1}, far, {100, 0, 1}, far, {100, 100, 1}, {0, 100, 1}}}}, tally), core::Error);
}

TEST(BreaklineArea, WhatLiesElsewhereIsLeftOutAndCounted) {
  core::Tally tally;
  const Breakline here{BreaklineKind::breakline, "e", {{{0, 0, 1}, {0, 5, 1}}}};
  const Breakline line{BreaklineKind::breakline, "f", {{{1e6, 0, 1}, {1e6, 5, 1}}}};
  const Breakline lake{BreaklineKind::lake, "g", {{{1e6, 0, 1}, {1e6, 5, 1}, {2e6, 5, 1}}}};
  std::vector<Breakline> all{here, line, lake};
  keep_in_area(all, area, origin, tally);
  EXPECT_EQ(all.size(), 1u);
  EXPECT_EQ(tally.of("breaklines with nothing in the survey's area, left out"), 2u);
  all = {line, lake};
  EXPECT_THROW(keep_in_area(all, area, origin, tally), core::Error);
}

}  // namespace
}  // namespace swath::terrain
