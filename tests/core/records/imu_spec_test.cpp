// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/records/imu_spec.h"

#include <gtest/gtest.h>

#include "core/config/option_visitors.h"

namespace {

using namespace swath::core;

TEST(ImuSpec, GradesGetWorseInOrder) {
  const ImuGrade order[] = {ImuGrade::perfect, ImuGrade::navigation, ImuGrade::tactical,
                            ImuGrade::compact, ImuGrade::mems,       ImuGrade::consumer};
  for (size_t i = 1; i < std::size(order); ++i) {
    const ImuErrorModel a = error_model_of(order[i - 1]), b = error_model_of(order[i]);
    EXPECT_LT(a.gyro_bias, b.gyro_bias);
    EXPECT_LT(a.gyro_drift, b.gyro_drift);
    EXPECT_LT(a.angular_random_walk, b.angular_random_walk);
    EXPECT_LT(a.gyro_scale, b.gyro_scale);
    EXPECT_LT(a.accelerometer_bias, b.accelerometer_bias);
    EXPECT_LT(a.accelerometer_drift, b.accelerometer_drift);
    EXPECT_LT(a.velocity_random_walk, b.velocity_random_walk);
    EXPECT_LT(a.accelerometer_scale, b.accelerometer_scale);
  }
}

TEST(ImuSpec, StatedValuesStandBeforeTheGrade) {
  ImuSpec spec;
  spec.grade = ImuGrade::mems;
  spec.gyro_bias = RadiansPerSecond(1e-6);
  EXPECT_DOUBLE_EQ(spec.model().gyro_bias.value, 1e-6);
  EXPECT_EQ(spec.model().gyro_scale, error_model_of(ImuGrade::mems).gyro_scale);
}

TEST(ImuSpec, UnitsOfDataSheetsAreRead) {
  std::string fault;
  EXPECT_NEAR(*parse_quantity(Dimension::angular_walk, "0.1 deg/sqrt(h)", fault), 0.1 * degree / 60, 1e-18);
  EXPECT_NEAR(*parse_quantity(Dimension::velocity_walk, "60 m/s/sqrt(h)", fault), 1.0, 1e-12);
  EXPECT_NEAR(*parse_quantity(Dimension::acceleration, "1000 ug", fault), 9.80665e-3, 1e-15);
  EXPECT_NEAR(*parse_quantity(Dimension::ratio, "300 ppm", fault), 3e-4, 1e-18);
}

}  // namespace
