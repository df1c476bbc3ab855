// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/axis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace swath::report {
namespace {

Reach reach(double low, double high) {
  Reach r;
  r.add(low);
  r.add(high);
  return r;
}

std::string texts(const Axis& a) {
  std::string out;
  for (const Tick& t : a.ticks) out += (out.empty() ? "" : " ") + t.text;
  return out;
}

TEST(Axis, TicksAreRoundAndNoMoreThanHaveRoom) {
  EXPECT_EQ(texts(make_axis(reach(0, 10), "x (m)", 6, 0.0)), "0 2 4 6 8 10");
  EXPECT_EQ(texts(make_axis(reach(-0.03, 0.05), "x (m)", 5, 0.0)), "-0.02 0 0.02 0.04");
  EXPECT_EQ(texts(make_axis(reach(3, 970), "x (m)", 5, 0.0)), "200 400 600 800");
  for (const double length : {1e-9, 3e-7, 0.11, 1.0, 7.0, 99.9, 12345.0, 1e8})
    for (const int most : {2, 5, 12}) {
      const Axis a = make_axis(reach(-0.3 * length, 0.7 * length), "x", most, 0.0);
      EXPECT_LE(static_cast<int>(a.ticks.size()), most + 1) << length;
      EXPECT_GE(a.ticks.size(), 1u) << length;
      for (const Tick& t : a.ticks) {
        EXPECT_GE(t.value, a.low - 1e-9 * length);
        EXPECT_LE(t.value, a.high + 1e-9 * length);
        EXPECT_LE(t.text.size(), 8u) << t.text;
      }
    }
}

TEST(Axis, LargeValuesAreShownFromARoundOffset) {
  const Axis time = make_axis(reach(474012.3, 474890.1), "time (s)", 5, 0.0);
  EXPECT_EQ(time.label, "time since 474000 s (s)");
  EXPECT_EQ(texts(time), "200 400 600 800");
  EXPECT_DOUBLE_EQ(time.ticks[0].value, 474200.0);
  // The margin below a round first value is no reason for a smaller offset.
  EXPECT_EQ(make_axis(reach(474000.0, 474890.1), "time (s)", 5, 0.05).label, "time since 474000 s (s)");
  const Axis gps = make_axis(reach(1400474123.25, 1400474154.5), "GPS time (s)", 8, 0.0);
  EXPECT_EQ(gps.label, "GPS time since 1400474100 s (s)");
  EXPECT_EQ(texts(gps), "25 30 35 40 45 50");
  const Axis map = make_axis(reach(5321100.0, 5321900.0), "northing (m)", 4, 0.0);
  EXPECT_EQ(map.label, "northing from 5321000 m (m)");
  EXPECT_EQ(make_axis(reach(0, 4000), "time (s)", 5, 0.0).label, "time (s)");
  EXPECT_EQ(make_axis(reach(7000.5, 7000.9), "turns", 5, 0.0).label, "turns");
  EXPECT_EQ(make_axis(reach(-90210.5, -90210.1), "turns", 5, 0.0).label, "turns from -90211");
}

TEST(Axis, NothingAConstantAndOneValueHaveRoomAround) {
  const Axis none = make_axis(Reach(), "x (m)", 5, 0.05);
  EXPECT_LT(none.low, none.high);
  EXPECT_FALSE(none.ticks.empty());
  for (const double v : {0.0, 5.0, -3e6, 1e-12, 1.4e9}) {
    const Axis a = make_axis(reach(v, v), "x (m)", 5, 0.05);
    EXPECT_LT(a.low, v);
    EXPECT_GT(a.high, v);
    EXPECT_GE(a.ticks.size(), 1u) << v;
    EXPECT_NEAR(a.share(v), 0.5, 1e-3) << v;
  }
  Reach r;
  r.add(std::numeric_limits<double>::quiet_NaN());
  r.add(std::numeric_limits<double>::infinity());
  r.add(0.0, true);
  EXPECT_TRUE(r.empty());
}

TEST(Axis, LogarithmicTicksArePowersOfTenAndTwoAndFiveWhereFew) {
  EXPECT_EQ(texts(make_axis(reach(1e-3, 1e3), "x", 8, 0.0, true)), "0.001 0.01 0.1 1 10 100 1000");
  EXPECT_EQ(texts(make_axis(reach(0.9, 30), "x", 8, 0.0, true)), "1 2 5 10 20");
  const Axis wide = make_axis(reach(1e-12, 1e12), "x", 6, 0.0, true);
  EXPECT_LE(wide.ticks.size(), 7u);
  EXPECT_NEAR(wide.share(1.0), 0.5, 1e-12);
  EXPECT_TRUE(std::isnan(wide.share(0.0)));
  EXPECT_TRUE(std::isnan(wide.share(-1.0)));
  const Axis narrow = make_axis(reach(1.2, 1.9), "x", 6, 0.0, true);
  EXPECT_GE(narrow.ticks.size(), 3u);
}

}  // namespace
}  // namespace swath::report
