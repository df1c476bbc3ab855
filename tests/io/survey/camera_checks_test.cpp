// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/camera_checks.h"

#include <gtest/gtest.h>

#include <functional>

#include "io/text/value_file.h"
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
    SurveyCamera& camera = survey.cameras.emplace_back();
    camera.columns = 4000, camera.rows = 3000, camera.pixel = core::Metres(5e-6);
    survey.images.emplace_back().file = "list.csv";
    ImageFile& points = survey.image_points.emplace_back();
    points.file = "points.csv";
    points.unit = ImageUnit::mm, points.y = ImageY::up, points.origin = ImageOrigin::middle, points.sigma_pixels = 0.3;
  }
  /// The keys of all faults of a survey that is changed so.
  std::string faults_of(const std::function<void(Survey&)>& change, const core::Value& tree = core::Value::object()) const {
    Survey changed = survey;
    change(changed);
    std::vector<core::Fault> faults;
    check_cameras(changed, tree, faults);
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
  EXPECT_EQ(faults_of([](Survey& s) { s.image_points[0].unit.reset(), s.image_points[0].y.reset(), s.image_points[0].origin.reset(); }),
            "image_points[1].unit image_points[1].y image_points[1].origin");
  EXPECT_EQ(faults_of([](Survey& s) { s.cameras[0].k1 = 1e-5; }), "camera[1].distortion");
  EXPECT_EQ(faults_of([](Survey& s) { s.cameras[0].sigma.p2 = "free"; }), "camera[1].distortion");
  EXPECT_EQ(faults_of([](Survey& s) { s.cameras[0].sigma.p2 = "free", s.cameras[0].distortion = core::DistortionAt::ideal; }), "");
}

TEST_F(CameraTables, MountLeverArmAndPrincipalDistanceAreNeverGuessed) {
  const auto same = [](Survey&) {};
  EXPECT_EQ(faults_of(same, parse_toml("[[camera]]\nname = \"camera\"\n", "s.toml")), "camera[1].mount camera[1].lever_arm camera[1].f");
  const core::Value full = parse_toml("[[camera]]\nf = \"50 mm\"\nmount = \"0 deg\"\nlever_arm = [\"0 m\", \"0 m\", \"0 m\"]\n", "s.toml");
  EXPECT_EQ(faults_of(same, full), "");
  // Without image points nothing needs the principal distance.
  const core::Value mounted = parse_toml("[[camera]]\nmount = \"0 deg\"\nlever_arm = [\"0 m\", \"0 m\", \"0 m\"]\n", "s.toml");
  EXPECT_EQ(faults_of([](Survey& s) { s.image_points.clear(); }, mounted), "");
}

TEST_F(CameraTables, WhatAFormatFixesIsNotStated) {
  const auto as_opensfm = [](Survey& s) {
    test::write_bytes(s.folder / "reconstruction.json", "[]");
    s.image_points[0].format = ImageFormat::opensfm;
    s.image_points[0].y.reset(), s.image_points[0].origin.reset();
  };
  EXPECT_EQ(faults_of(as_opensfm), "image_points[1].unit");  // mm
  EXPECT_EQ(faults_of([&](Survey& s) { as_opensfm(s), s.image_points[0].unit.reset(); }), "");
}

TEST_F(CameraTables, PixelsNeedASensor) {
  const auto in_millimetres = [](Survey& s) {
    s.cameras[0].rows = 0;
    s.image_points[0].sigma_pixels.reset(), s.image_points[0].sigma = core::Metres(3e-6);
  };
  EXPECT_EQ(faults_of(in_millimetres), "");
  EXPECT_EQ(faults_of([](Survey& s) { s.cameras[0].rows = 0; }), "camera[1].pixel") << "of the sigma";
  EXPECT_EQ(faults_of([&](Survey& s) { in_millimetres(s), s.image_points[0].unit = ImageUnit::pixel; }), "camera[1].pixel");
  EXPECT_EQ(faults_of([&](Survey& s) { in_millimetres(s), s.image_points[0].origin = ImageOrigin::corner; }), "camera[1].pixel");
}

TEST_F(CameraTables, TablesNeedOneAnother) {
  EXPECT_EQ(faults_of([](Survey& s) { s.cameras.clear(); }), "image image_points");
  EXPECT_EQ(faults_of([](Survey& s) { s.events.clear(); }), "camera");
  EXPECT_EQ(faults_of([](Survey& s) { s.cameras.emplace_back(); }), "camera[2].name camera[2].pixel");
  const auto unnamed = [](Survey& s) { s.cameras.emplace_back().name.clear(); };
  EXPECT_EQ(faults_of(unnamed), "camera[2].name camera[2].pixel");
}

TEST_F(CameraTables, FilesAreThere) {
  EXPECT_EQ(faults_of([](Survey& s) { s.images[0].file = "other.csv"; }), "image[1].file");
  EXPECT_EQ(faults_of([](Survey& s) { s.image_points[0].file.clear(); }), "image_points[1].file");
  const auto as_colmap = [](Survey& s) {
    ImageFile& f = s.image_points[0];
    f.file = "sparse", f.format = ImageFormat::colmap;
    f.unit.reset(), f.y.reset(), f.origin.reset();
  };
  EXPECT_EQ(faults_of(as_colmap), "image_points[1].file");
  test::write_bytes(folder / "sparse/cameras.txt", "");
  test::write_bytes(folder / "sparse/images.txt", "");
  EXPECT_EQ(faults_of(as_colmap), "") << "a model is a folder";
}

}  // namespace
}  // namespace swath::io
