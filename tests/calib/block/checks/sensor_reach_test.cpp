// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/sensor_reach.h"

#include <gtest/gtest.h>

#include "calib/block/mark_plane.h"
#include "core/error.h"

namespace swath::calib {
namespace {

using io::ImageOrigin;
using io::ImageUnit;
using io::ImageY;

/// A file of points all over a sensor of 4000 x 3000 pixels of 5 um, in one convention, read as if it had another.
std::string refused(ImageUnit unit, ImageOrigin origin, ImageUnit stated_unit, ImageOrigin stated_origin, ImageY y) {
  BlockConfig config;
  config.cameras.resize(1);
  config.cameras[0].name = "C";
  config.cameras[0].columns = 4000, config.cameras[0].rows = 3000, config.cameras[0].pixel = core::Metres(5e-6);
  config.image_points.resize(1);
  config.image_points[0].unit = stated_unit, config.image_points[0].origin = stated_origin, config.image_points[0].y = y;
  ReadBlock read;
  read.block.images.resize(1);
  io::ImageData stated;
  stated.unit = stated_unit, stated.origin = stated_origin, stated.y = y;
  const double length = unit == ImageUnit::mm ? 0.005 : unit == ImageUnit::um ? 5.0 : 1.0;  // of a pixel, in the file
  const bool from_corner = origin != ImageOrigin::middle;
  for (int i = 0; i <= 10; ++i)
    for (int j = 0; j <= 10; ++j) {
      io::ImageMark m;
      m.x = length * (400.0 * i - (from_corner ? 0.0 : 2000.0)), m.y = length * (300.0 * j - (from_corner ? 0.0 : 1500.0));
      const Eigen::Vector2d p = on_plane(stated, m, config.cameras[0]);
      read.block.rays.push_back({0, 0, p.x(), p.y()});
    }
  try {
    refuse_off_sensor(read, config);
  } catch (const core::Error& e) {
    return e.text();
  }
  return {};
}

void expect_in(const std::string& text, const std::string& part) { EXPECT_NE(text.find(part), std::string::npos) << text; }

TEST(SensorReach, PointsOnTheSensorPass) {
  for (const ImageUnit unit : {ImageUnit::mm, ImageUnit::um, ImageUnit::pixel})
    for (const ImageOrigin origin : {ImageOrigin::middle, ImageOrigin::corner, ImageOrigin::pixel_centre})
      for (const ImageY y : {ImageY::up, ImageY::down}) EXPECT_EQ(refused(unit, origin, unit, origin, y), "");
}

TEST(SensorReach, TheOrigin) {
  for (const ImageUnit unit : {ImageUnit::mm, ImageUnit::um, ImageUnit::pixel})
    for (const ImageY y : {ImageY::up, ImageY::down}) {
      expect_in(refused(unit, ImageOrigin::corner, unit, ImageOrigin::middle, y), "count from a corner of the sensor, not from its middle");
      for (const ImageOrigin stated : {ImageOrigin::corner, ImageOrigin::pixel_centre})
        expect_in(refused(unit, ImageOrigin::middle, unit, stated, y), "count from the middle of the sensor, not from a corner");
    }
}

TEST(SensorReach, TheUnit) {
  const ImageUnit units[] = {ImageUnit::mm, ImageUnit::um, ImageUnit::pixel};
  for (const ImageUnit unit : units)
    for (const ImageUnit stated : units)
      for (const ImageOrigin origin : {ImageOrigin::middle, ImageOrigin::corner})
        for (const ImageY y : {ImageY::up, ImageY::down}) {
          if (unit == stated) continue;
          const std::string found = refused(unit, origin, stated, origin, y);
          expect_in(found, "the image points are in " + std::string(core::Choices<ImageUnit>::names[static_cast<size_t>(unit)]));
        }
}

/// A part of the sensor, as of points along a coast, is no mistake of a unit.
TEST(SensorReach, APartOfTheSensorPasses) {
  BlockConfig config;
  config.cameras.resize(1);
  config.cameras[0].columns = 4000, config.cameras[0].rows = 3000, config.cameras[0].pixel = core::Metres(5e-6);
  config.image_points.resize(1);
  config.image_points[0].unit = ImageUnit::mm, config.image_points[0].origin = ImageOrigin::middle, config.image_points[0].y = ImageY::up;
  ReadBlock read;
  read.block.images.resize(1);
  for (int i = 0; i < 30; ++i) read.block.rays.push_back({0, 0, 5.0 + 0.05 * i, 1.0 + 0.02 * (i % 7)});
  EXPECT_NO_THROW(refuse_off_sensor(read, config));
}

}  // namespace
}  // namespace swath::calib
