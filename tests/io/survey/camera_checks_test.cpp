// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/camera_checks.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/world/support.h"

namespace swath::io {
namespace {

class CameraTables : public testing::Test {
 protected:
  CameraTables() {
    survey.folder = folder.path();
    test::write_bytes(folder / "points.csv", "image,point,x,y\n");
    test::write_bytes(folder / "list.csv", "name,event\n");
    survey.events.emplace_back().file = "events.csv";
    survey.cameras.emplace_back();
    survey.images.emplace_back().file = "list.csv";
    ImageFile& points = survey.image_points.emplace_back();
    points.file = "points.csv";
    points.unit = ImageUnit::mm, points.y = ImageY::up, points.origin = ImageOrigin::middle, points.sigma_pixels = 0.3;
  }
  /// The keys of all faults of a survey that is changed so.
  std::string faults_of(const std::function<void(Survey&)>& change) const {
    Survey changed = survey;
    change(changed);
    std::vector<core::Fault> faults;
    check_cameras(changed, core::Value::object(), faults);
    std::string out;
    for (const core::Fault& f : faults) out += (out.empty() ? "" : " ") + f.key;
    return out;
  }
  const test::TemporaryFolder folder;
  Survey survey;
};

TEST_F(CameraTables, AFullSurveyHasNoFault) {
  EXPECT_EQ(faults_of([](Survey&) {}), "");
}

TEST_F(CameraTables, WhatIsNotStatedIsAFault) {
  EXPECT_EQ(faults_of([](Survey& s) { s.image_points[0].sigma_pixels.reset(); }), "image_points[1].sigma");
  EXPECT_EQ(faults_of([](Survey& s) { s.image_points[0].unit.reset(), s.image_points[0].y.reset(), s.image_points[0].origin.reset(); }),
            "image_points[1].unit image_points[1].y image_points[1].origin");
  EXPECT_EQ(faults_of([](Survey& s) { s.cameras[0].k1 = 1e-5; }), "camera[1].distortion");
  EXPECT_EQ(faults_of([](Survey& s) { s.cameras[0].sigma.p2 = "free"; }), "camera[1].distortion");
  EXPECT_EQ(faults_of([](Survey& s) { s.cameras[0].sigma.p2 = "free", s.cameras[0].distortion = core::DistortionAt::ideal; }), "");
}

TEST_F(CameraTables, TablesNeedOneAnother) {
  EXPECT_EQ(faults_of([](Survey& s) { s.cameras.clear(); }), "image image_points");
  EXPECT_EQ(faults_of([](Survey& s) { s.events.clear(); }), "camera");
  EXPECT_EQ(faults_of([](Survey& s) { s.cameras.emplace_back(); }), "camera[2].name");
}

TEST_F(CameraTables, FilesAreThere) {
  EXPECT_EQ(faults_of([](Survey& s) { s.images[0].file = "other.csv"; }), "image[1].file");
  EXPECT_EQ(faults_of([](Survey& s) { s.image_points[0].file.clear(); }), "image_points[1].file");
  const auto as_colmap = [](Survey& s) { s.image_points[0].file = "sparse", s.image_points[0].format = ImageFormat::colmap; };
  EXPECT_EQ(faults_of(as_colmap), "image_points[1].file");
  test::write_bytes(folder / "sparse/cameras.txt", "");
  test::write_bytes(folder / "sparse/images.txt", "");
  EXPECT_EQ(faults_of(as_colmap), "") << "a model is a folder";
}

}  // namespace
}  // namespace swath::io
