// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/oriented_images.h"

#include <gtest/gtest.h>

#include "core/config/units.h"
#include "core/error.h"
#include "tests/calib/block/imagery/made_photos.h"

namespace swath::calib::test {
namespace {

namespace fs = std::filesystem;
using swath::test::write_bytes;

const std::vector<MadePhoto> two{{"1", {50, 50, 100}, {0.02, -0.03, 0.4}, 0.05}, {"2", {80, 50, 101}}};

TEST(OrientedImages, PlaceRotationAndCovarianceAreTheTables) {
  const MadePhotos photos(two);
  const OrientedImages read = photos.read();
  ASSERT_EQ(read.images.size(), 2u);
  const OrientedImage& image = read.images[0];
  EXPECT_EQ(image.file, photos.folder() / "photos" / "1.tif");
  EXPECT_TRUE(image.map.isApprox(two[0].place));
  EXPECT_TRUE(image.camera_R_local.isApprox(rotation_of(two[0].tilt).transpose(), 1e-9));
  EXPECT_NEAR(image.covariance(2, 2), 0.0025, 1e-8);
  EXPECT_NEAR(image.covariance(5, 5), 2.5e-11, 1e-16);
  EXPECT_TRUE(image.has_covariance);
  EXPECT_EQ(read.bits, 8);
  EXPECT_TRUE(read.without_file.empty());
}

TEST(OrientedImages, AnglesAloneGiveTheSameRotation) {
  const MadePhotos photos(two);
  write_bytes(photos.folder() / "orientation.csv", "image,x,y,z,omega,phi,kappa\n1.tif,50,50,100,1.145915590,-1.718873385,22.918311805\n");
  const OrientedImages read = photos.read();
  ASSERT_EQ(read.images.size(), 1u);  // named with its extension
  EXPECT_TRUE(read.images[0].camera_R_local.isApprox(rotation_of(two[0].tilt).transpose(), 1e-8));
  EXPECT_FALSE(read.images[0].has_covariance);
}

TEST(OrientedImages, AMapInFeetAndAnotherCrsOfTheTable) {
  const MadePhotos photos({{"1", {50, 50, 100}}});
  PhotoSource source = photos.source();
  // Of one place, in UTM zone 32 and in zone 33 with the grid turned.
  write_bytes(source.orientation, "# crs: EPSG:25832; omega phi kappa, deg\nimage,x,y,z,omega,phi,kappa\n1,770000,5500000,900,0,0,30\n");
  const OrientedImages own = read_oriented_images({source}, {"EPSG:25832", 1.0, 1.0});
  const OrientedImages other = read_oriented_images({source}, {"EPSG:25833", 1.0, 1.0});
  EXPECT_NEAR(own.images[0].map.x(), 770000, 1e-4);
  EXPECT_GT((own.images[0].map - other.images[0].map).norm(), 1e5);
  const Eigen::Vector3d below(0, 0, -300);  // both frames have the image in their middle, north up
  EXPECT_TRUE((own.images[0].camera_R_local * below).isApprox(other.images[0].camera_R_local * below, 1e-6));
  const Eigen::Vector3d beside(100, 0, 0);
  EXPECT_TRUE((own.images[0].camera_R_local * beside).isApprox(other.images[0].camera_R_local * beside, 1e-6));
  const OrientedImages feet = read_oriented_images({source}, {"EPSG:25832", 0.3048, 1.0});
  EXPECT_NEAR(feet.images[0].map.x(), 770000 * 0.3048, 1e-4);
  EXPECT_NEAR(feet.images[0].map.z(), 900, 1e-4);
}

TEST(OrientedImages, WhatTheFolderDoesNotHaveIsLeftOutByName) {
  const MadePhotos photos(two);
  fs::remove(photos.folder() / "photos" / "2.tif");
  const OrientedImages read = photos.read();
  EXPECT_EQ(read.images.size(), 1u);
  EXPECT_EQ(read.without_file, std::vector<std::string>{"2"});
  fs::remove(photos.folder() / "photos" / "1.tif");
  EXPECT_NE(message_of([&] { photos.read(); }).find("no file in the folder matches an oriented image (first: 1)"), std::string::npos);
}

TEST(OrientedImages, MistakesAreNamed) {
  const MadePhotos photos(two);
  fs::copy(photos.folder() / "photos" / "1.tif", photos.folder() / "photos" / "1.png");
  EXPECT_NE(message_of([&] { photos.read(); }).find("two files may be image 1"), std::string::npos);
  fs::remove(photos.folder() / "photos" / "1.png");
  write_bytes(photos.folder() / "photos" / "1.tfw", "a world file is none");

  PhotoSource source = photos.source();
  source.cameras[0].columns = 241;
  const auto read = [&] { read_oriented_images({source}, {}); };
  EXPECT_NE(message_of(read).find("the image has 240 x 160 pixels, camera small has 241 x 160"), std::string::npos);
  source = photos.source();
  source.cameras[0].name = "large";
  EXPECT_NE(message_of(read).find("camera small is not in camera.toml"), std::string::npos);
  source = photos.source();
  source.cameras[0].pixel.reset();
  EXPECT_THROW(read(), core::Error);
  source = photos.source();
  source.folder = photos.folder() / "none";
  EXPECT_NE(message_of(read).find("no such folder"), std::string::npos);

  const std::string table = orientation_header("local");
  source = photos.source();
  write_bytes(source.orientation, table + orientation_row(two[0]) + orientation_row(two[0]));
  EXPECT_NE(message_of(read).find("image 1 is listed twice, first in"), std::string::npos);
  std::string mirrored = table + orientation_row({"1", {50, 50, 100}});
  mirrored.replace(mirrored.find(",1.000000000000"), 15, ",-1.00000000000");
  write_bytes(source.orientation, mirrored);
  EXPECT_NE(message_of(read).find("not a rotation matrix"), std::string::npos);
}

TEST(OrientedImages, NamesDoNotDependOnCaseAndFolders) {
  const MadePhotos photos({{"dsc_1.2", {50, 50, 100}}});
  const fs::path folder = photos.folder() / "photos";
  fs::rename(folder / "dsc_1.2.tif", folder / "DSC_1.2.TIF");
  const std::string table = "image,x,y,z,omega,phi,kappa\n";
  for (const std::string name : {"dsc_1.2", "DSC_1.2.tif", "flight 1/dsc_1.2.JPG"}) {
    write_bytes(photos.source().orientation, table + name + ",50,50,100,0,0,0\n");
    EXPECT_EQ(photos.read().images.at(0).file, folder / "DSC_1.2.TIF") << name;
  }
  write_bytes(photos.source().orientation, table + "dsc_1.3,50,50,100,0,0,0\n");
  EXPECT_THROW(photos.read(), core::Error);  // not dsc_1
}

TEST(OrientedImages, RotationsThatContradictAndCamerasThatLookUpAreNamed) {
  const MadePhotos photos({{"1", {50, 50, 100}, {0.02, -0.03, 0.4}}});
  const std::string header = orientation_header("local");
  ImageOrientation o;
  o.map = {50, 50, 100};
  o.grid_R_camera = rotation_of({0.02, -0.03, 0.4});
  const std::string right = orientation_line("1", "small", 1, o);
  o.grid_R_camera.transposeInPlace();
  const std::string transposed = orientation_line("1", "small", 1, o);
  const auto from = [](const std::string& line, int field) {  // where a field begins
    size_t at = 0;
    for (int k = 0; k < field; ++k) at = line.find(',', at) + 1;
    return at;
  };
  const int matrix = 12, covariance = 21;  // fields before them
  const std::string mixed = right.substr(0, from(right, matrix)) +
                            transposed.substr(from(transposed, matrix), from(transposed, covariance) - from(transposed, matrix)) +
                            right.substr(from(right, covariance));
  write_bytes(photos.source().orientation, header + mixed);
  EXPECT_NE(message_of([&] { photos.read(); }).find("are the transpose of the rotation by omega, phi, kappa"), std::string::npos);
  const std::string angles = right.substr(0, from(right, 6)) + "1.5" + right.substr(from(right, 7) - 1);
  write_bytes(photos.source().orientation, header + angles);
  EXPECT_NE(message_of([&] { photos.read(); }).find("omega, phi, kappa of image 1 differ by "), std::string::npos);
  write_bytes(photos.source().orientation, "image,x,y,z,omega,phi,kappa\n1,50,50,100,180,0,0\n");
  EXPECT_NE(message_of([&] { photos.read(); }).find("all cameras look up"), std::string::npos);
  write_bytes(photos.source().orientation, "image,x,y,z,omega,phi,kappa,r11\n1,50,50,100,0,0,0,1\n");
  EXPECT_NE(message_of([&] { photos.read(); }).find("only 1 of the columns r11 to r33"), std::string::npos);
}

TEST(OrientedImages, CovariancesOfTheCameraAreThoseBesideTheTable) {
  const MadePhotos photos(two);
  JointCovariance joint;
  joint.cameras["small"] = 1e-6 * CameraCovariance::Identity();
  joint.images["1"] = PoseByCamera::Constant(2e-7);
  write_bytes(photos.folder() / joint_covariance_file, joint_covariance_csv("local", joint));
  const OrientedImages read = photos.read();
  EXPECT_TRUE(read.camera_covariance[0].isApprox(joint.cameras["small"], 1e-6));
  EXPECT_TRUE(read.images[0].with_camera.isApprox(joint.images["1"], 1e-6));
  EXPECT_TRUE(read.images[1].with_camera.isZero(0.0));
}

TEST(OrientedImages, HeightsWithoutARelationAreRefused) {
  const MadePhotos photos({{"1", {50, 50, 100}}});
  PhotoSource source = photos.source();
  write_bytes(source.orientation,
              "# crs: EPSG:25832+7837; omega phi kappa, deg\nimage,x,y,z,omega,phi,kappa\n1,600000,5500000,900,0,0,30\n");
  EXPECT_NE(message_of([&] {
              read_oriented_images({source}, {"EPSG:25832", 1.0, 1.0});
            }).find("heights of the orientations are"),
            std::string::npos);
  EXPECT_THROW(read_oriented_images({source}, {}), core::Error);  // a map without a CRS
}

}  // namespace
}  // namespace swath::calib::test
