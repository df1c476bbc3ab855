// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/units.h"

#include <gtest/gtest.h>

#include <limits>

namespace swath::core {
namespace {

TEST(Units, ReadsEveryUnitAndShowsTheFirst) {
  std::string fault;
  EXPECT_DOUBLE_EQ(*parse_quantity(Dimension::length, "12.5 cm", fault), 0.125);
  EXPECT_DOUBLE_EQ(*parse_quantity(Dimension::length, "-3ft", fault), -0.9144);
  for (const char* survey_foot : {"3937 us-ft", "3937 ftUS", "3937 US-ft", "3937 ft_us", "3937 usft", "3937 US survey foot"})
    EXPECT_DOUBLE_EQ(parse_quantity(Dimension::length, survey_foot, fault).value_or(0.0), 1200.0) << survey_foot;
  EXPECT_DOUBLE_EQ(*parse_quantity(Dimension::angle, "180 deg", fault), pi);
  EXPECT_DOUBLE_EQ(*parse_quantity(Dimension::temperature, "15 degC", fault), 288.15);
  EXPECT_DOUBLE_EQ(*parse_quantity(Dimension::memory, "2 GB", fault), 2e9);
  EXPECT_EQ(format_quantity(Dimension::angle, 0.11 * degree), "0.11 deg");
  EXPECT_EQ(format_quantity(Dimension::temperature, 288.15), "15 degC");
}

TEST(Units, SaysWhatIsWrong) {
  std::string fault;
  EXPECT_FALSE(parse_quantity(Dimension::length, "5", fault));
  EXPECT_NE(fault.find("no unit"), std::string::npos);
  EXPECT_FALSE(parse_quantity(Dimension::length, "5 deg", fault));
  EXPECT_NE(fault.find("'deg' is not a unit of length"), std::string::npos);
  for (const char* comma : {"0,5 m", "1,000 m"}) {
    EXPECT_FALSE(parse_quantity(Dimension::length, comma, fault));
    EXPECT_NE(fault.find("write a decimal point"), std::string::npos) << fault;
  }
  EXPECT_FALSE(parse_quantity(Dimension::length, "wide", fault));
  EXPECT_FALSE(parse_quantity(Dimension::length, "inf m", fault));
}

TEST(Units, NumbersOfMessagesAreRounded) {
  EXPECT_EQ(format_number(0.0099999997764826, 4), "0.01");
  EXPECT_EQ(format_number(2.86478897565412, 4), "2.865");
  EXPECT_EQ(format_number(-123456.0, 4), "-123500");
  EXPECT_EQ(format_number(0.5, 4), "0.5");
  EXPECT_EQ(format_number(std::numeric_limits<double>::infinity(), 4), format_number(std::numeric_limits<double>::infinity()));
}

TEST(Units, CountedNounsAreSingularOnlyForOne) {
  EXPECT_EQ(counted(0, "point"), "0 points");
  EXPECT_EQ(counted(1, "point"), "1 point");
  EXPECT_EQ(counted(2, "point"), "2 points");
  EXPECT_EQ(counted(1, "vertex is", "vertices are"), "1 vertex is");
  EXPECT_EQ(counted(12345, "vertex is", "vertices are"), "12345 vertices are");
}

TEST(Units, WhatIsShownReadsBack) {
  std::string fault;
  for (const Unit& u : units()) {
    const double si = 300.0 * u.factor + u.shift;
    EXPECT_NEAR(*parse_quantity(u.dimension, format_quantity(u.dimension, si), fault), si, std::abs(si) * 1e-13) << u.name;
  }
}

}  // namespace
}  // namespace swath::core
