// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_reading.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "tests/calib/block/made_files.h"

namespace swath::calib {
namespace {

std::string fault_of(const std::string& file) {
  try {
    read_block(test::read_made(file), file);
  } catch (const core::Error& e) {
    return e.text();
  }
  return {};
}

TEST(BlockReading, FilesGiveTheBlockThatWasWritten) {
  const test::TemporaryFolder folder;
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  const std::string file = test::write_made(m, folder.path());
  const ReadBlock read = read_block(test::read_made(file), file);
  ASSERT_EQ(read.block.images.size(), m.block.images.size());
  ASSERT_EQ(read.block.rays.size(), m.block.rays.size());
  ASSERT_EQ(read.block.control.size(), m.block.control.size());
  EXPECT_EQ(read.started_from, "stations and the directions of the strips");
  for (size_t r = 0; r < m.block.rays.size(); ++r) {
    EXPECT_NEAR(read.block.rays[r].y, m.block.rays[r].y, 1e-12);
    EXPECT_NEAR(read.block.rays[r].sigma, 0.01, 1e-15);
  }
  size_t heights = 0;
  for (const BlockControl& c : read.block.control) heights += !c.known[0];
  EXPECT_GT(heights, 0u);
  // Images start level and along their strip: within the attitudes of the made block.
  for (size_t i = 0; i < m.block.images.size(); ++i)
    EXPECT_LT(core::log_so3(read.block.images[i].camera_R_local * m.block.images[i].camera_R_local.transpose()).norm(), 0.2);
}

TEST(BlockReading, AnglesOfEveryKindAreTheSameAttitude) {
  for (const char* kind : {"roll_pitch_heading", "omega_phi_kappa", "phi_omega_kappa"}) {
    const test::TemporaryFolder folder;
    test::MadeFiles m;
    m.block = test::make_block(test::small_making()).given;
    m.write_angles = true;
    m.angles = m.stated_angles = kind;
    m.angle_use = "observed";
    const std::string file = test::write_made(m, folder.path());
    const ReadBlock read = read_block(test::read_made(file), file);
    ASSERT_EQ(read.block.attitudes.size(), m.block.attitudes.size());
    for (size_t i = 0; i < read.block.attitudes.size(); ++i)
      EXPECT_LT((read.block.attitudes[i].local_R_body - m.block.attitudes[i].local_R_body).norm(), 1e-12) << kind;
  }
}

TEST(BlockReading, WhatDoesNotFitTogetherIsNamed) {
  const test::TemporaryFolder folder;
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  const std::string file = test::write_made(m, folder.path());
  const std::string points = swath::test::read_bytes(folder.path() / "points.csv"),
                    images = swath::test::read_bytes(folder.path() / "images.csv"),
                    control = swath::test::read_bytes(folder.path() / "control.csv");
  const auto changed = [&](const char* name, const std::string& text) {
    swath::test::write_bytes(folder.path() / name, text);
    const std::string fault = fault_of(file);
    swath::test::write_bytes(folder.path() / "points.csv", points);
    swath::test::write_bytes(folder.path() / "images.csv", images);
    swath::test::write_bytes(folder.path() / "control.csv", control);
    return fault;
  };
  const std::string last = points.substr(points.rfind('\n', points.size() - 2) + 1);
  EXPECT_NE(changed("points.csv", points + last).find("measured twice: point"), std::string::npos);
  EXPECT_NE(changed("points.csv", points + "unknown.jpg,1,0,0\n").find("image unknown.jpg has image points and is not in the table"),
            std::string::npos);
  const std::string known = m.block.images[0].name;
  EXPECT_NE(
      changed("points.csv", points + "images/" + known + ".JPG,1,0,0\n").find("there is an image " + known + ": the names must be the"),
      std::string::npos);
  EXPECT_NE(changed("points.csv", points + ",1,0,0\n").find("the image of an image point has no name in column 'image'"),
            std::string::npos);
  EXPECT_NE(changed("points.csv", points + known + ",,0,0\n").find("the image point has no name in column 'point'"), std::string::npos);
  EXPECT_NE(changed("control.csv", control + ",1,2,3\n").find("the point has no name"), std::string::npos);
  EXPECT_NE(changed("images.csv", images + "empty.jpg,1,9999,0,0,4500\n").find("images without image points: empty.jpg"),
            std::string::npos);
  EXPECT_NE(changed("images.csv", images + images.substr(images.find('\n') + 1)).find("is there twice"), std::string::npos);
  const std::string first = control.substr(control.find('\n') + 1);
  EXPECT_NE(changed("control.csv", control + first.substr(0, first.find('\n') + 1)).find("is there twice, first in"), std::string::npos);
  swath::test::write_bytes(folder.path() / "heights.csv", "name,x,y,z\nother,0,0,0\n");
  EXPECT_NE(changed("control.csv", "name,x,y,z\nnone,0,0,0\n").find("no control point is measured on an image: none"), std::string::npos);
}

TEST(BlockReading, OptionsThatDoNothingAreRefused) {
  const test::TemporaryFolder folder;
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  m.drift = "strip";
  const std::string file = test::write_made(m, folder.path()), text = swath::test::read_bytes(file);
  EXPECT_EQ(fault_of(file), "");
  std::string other = text;
  other.replace(other.find("[images]"), 8, "[images]\nstations = \"start\"");
  swath::test::write_bytes(file, other);
  EXPECT_NE(fault_of(file).find("drift has no effect: no station is observed"), std::string::npos) << fault_of(file);
  swath::test::write_bytes(file, text + "[[camera]]\nname = \"RMK\"\nf = \"150 mm\"\n");
  EXPECT_NE(fault_of(file).find("two [[camera]] have the name RMK"), std::string::npos) << fault_of(file);
}

/// A run states covariances whatever takes part of them.
TEST(BlockReading, CovariancesOfValuesToStartFromAreNoObservations) {
  const test::TemporaryFolder folder;
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  m.write_angles = true;
  const std::string file = test::write_made(m, folder.path());
  CorrelationFile to(folder.path() / "correlation.csv", "local");
  for (const BlockImage& i : m.block.images) to.add(i.name, i.name, 1e-4 * PoseCovariance::Identity());
  to.commit();
  BlockConfig config = test::read_made(file);
  config.images.correlation = folder.path() / "correlation.csv";
  const size_t images = m.block.images.size();
  for (const bool stations : {false, true})
    for (const bool angles : {false, true}) {
      config.images.stations = stations ? ImageValues::observed : ImageValues::start;
      config.images.angle_use = angles ? ImageValues::observed : ImageValues::start;
      const ReadBlock read = read_block(config, file);
      EXPECT_EQ(read.covariance.size(), images);
      EXPECT_EQ(read.block.chain.size(), stations || angles ? images : 0);
      for (const NavigationStep& step : read.block.chain) EXPECT_EQ(step.root.rows(), 3 * (stations + angles));
    }
}

/// Image points of a program that had the images smaller would be taken for others, all of them by one factor.
TEST(BlockReading, ImagesOfAnotherSizeThanTheCamerasAreRefused) {
  const test::TemporaryFolder folder;
  const auto model = folder.path() / "sparse";
  std::filesystem::create_directories(model);
  swath::test::write_bytes(model / "cameras.txt", "1 PINHOLE 2000 1500 1600 1600 1000 750\n");
  swath::test::write_bytes(model / "images.txt", "1 0 1 0 0 0 0 100 1 a.jpg\n10 10 1\n2 0 1 0 0 -50 0 100 1 b.jpg\n20 10 1\n");
  const auto file = (folder.path() / "block.toml").string();
  const auto with = [&](const std::string& size, const std::string& more) {
    swath::test::write_bytes(file, "kind = \"block_adjust\"\ncrs = \"local\"\n[[camera]]\nname = \"1\"\nf = \"8 mm\"\npixel = \"5 um\"\n" +
                                       size + more + "[[image_points]]\nfile = \"sparse\"\nformat = \"colmap\"\nsigma_pixels = 0.5\n");
    return fault_of(file);
  };
  EXPECT_EQ(with("columns = 2000\nrows = 1500\n", ""), "");
  const std::string fault = with("columns = 4000\nrows = 3000\n", "");
  EXPECT_NE(fault.find("image a.jpg has 2000 x 1500 pixels in this file, camera 1 has 4000 x 3000 pixels"), std::string::npos) << fault;
  EXPECT_NE(with("columns = 1500\nrows = 2000\n", "").find("camera 1 has 1500 x 2000 pixels"), std::string::npos);
  // Point 1 of COLMAP is not the point 1 that somebody measured.
  swath::test::write_bytes(folder.path() / "p.csv", "image,point,x,y\na.jpg,1,500,500\nb.jpg,1,600,500\n");
  with("columns = 2000\nrows = 1500\n",
       "[[image_points]]\nfile = \"p.csv\"\nunit = \"pixel\"\ny = \"down\"\norigin = \"corner\"\nsigma_pixels = 0.5\n");
  std::vector<std::string> names;
  for (const BlockPoint& p : read_block(test::read_made(file), file).block.points) names.push_back(p.name);
  EXPECT_EQ(names, (std::vector<std::string>{"1", "2:1"}));
  // Which camera took an image must be stated somewhere.
  swath::test::write_bytes(folder.path() / "p.csv", "image,point,x,y\na,1,0,0\n");
  swath::test::write_bytes(file,
                           "kind = \"block_adjust\"\ncrs = \"local\"\n[[camera]]\nname = \"a\"\nf = \"8 mm\"\n[[camera]]\nname = \"b\"\nf "
                           "= \"8 mm\"\n[[image_points]]\n"
                           "file = \"p.csv\"\nunit = \"mm\"\ny = \"up\"\norigin = \"middle\"\nsigma = \"5 um\"\n");
  EXPECT_NE(fault_of(file).find("several cameras, and the file does not say which took image a"), std::string::npos) << fault_of(file);
}

void write(const std::filesystem::path& file, const OrientationCorrelation& correlation, const std::string& crs) {
  CorrelationFile to(file, crs);
  for (const CovariancePair& p : correlation.pairs) to.add(correlation.images[p.image], correlation.images[p.other], p.value);
  to.commit();
}

/// A file of correlations takes the place of all sigmas of stations and angles.
TEST(BlockReading, CorrelationsMakeAChain) {
  const test::TemporaryFolder folder;
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  m.write_angles = true;
  m.angle_use = "observed";
  const std::string file = test::write_made(m, folder.path());
  OrientationCorrelation correlation;
  PoseCovariance C = PoseCovariance::Zero();
  C.diagonal() << 0.04, 0.09, 0.16, 1e-8, 4e-8, 9e-8;
  for (std::uint32_t i = 0; i < m.block.images.size(); ++i) {
    correlation.images.push_back(m.block.images[i].name);
    if (i > 0) correlation.pairs.push_back({i, i - 1, 0.6 * C});
    correlation.pairs.push_back({i, i, C});
  }
  write(folder / "correlation.csv", correlation, "local");
  BlockConfig config = test::read_made(file);
  config.images.correlation = folder / "correlation.csv";
  const ReadBlock read = read_block(config, file);
  ASSERT_EQ(read.block.chain.size(), m.block.images.size());
  EXPECT_LT((read.block.stations[2].covariance - C.topLeftCorner<3, 3>()).norm(), 1e-12);
  EXPECT_LT((read.block.attitudes[2].covariance - C.bottomRightCorner<3, 3>()).norm(), 1e-18);
  const NavigationStep& step = read.block.chain[1];
  EXPECT_EQ(step.image, 1u);
  EXPECT_EQ(step.before, std::vector<std::uint32_t>{0u});
  EXPECT_LT((step.by_before - 0.6 * Eigen::MatrixXd::Identity(6, 6)).norm(), 1e-6);
  // The image's y axis points to the left of the body here: variances are the same.
  EXPECT_NEAR(step.root(1, 1), std::sqrt(0.64 * 0.09), 1e-9);
  EXPECT_NEAR(step.root(4, 4), std::sqrt(0.64 * 4e-8), 1e-12);
  config.images.angle_use = ImageValues::start;
  EXPECT_EQ(read_block(config, file).block.chain[1].root.rows(), 3);
  correlation.images[3] = "other";
  write(folder / "correlation.csv", correlation, "local");
  try {
    read_block(config, file);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_EQ(std::string(e.what()), "image " + m.block.images[3].name + " is not in the file of correlations");
  }
  write(folder / "correlation.csv", correlation, "EPSG:32632");
  try {
    read_block(config, file);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_EQ(std::string(e.what()), "its covariances are on the grid of EPSG:32632, the block is on that of local");
  }
  config.images.correlation.clear();
  EXPECT_TRUE(read_block(config, file).block.chain.empty());
}

TEST(BlockReading, ADatumNeedsStationsAndControl) {
  const test::TemporaryFolder folder;
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  const std::string file = test::write_made(m, folder.path());
  const auto fault_with = [&](Datum datum, size_t control, ImageValues stations = ImageValues::observed) -> std::string {
    BlockConfig config = test::read_made(file);
    config.datum = datum, config.control.resize(control), config.images.stations = stations;
    try {
      read_block(config, file);
    } catch (const core::Error& e) {
      return e.text();
    }
    return "";
  };
  EXPECT_EQ(fault_with(Datum::similarity, 2), "");
  EXPECT_EQ(fault_with(Datum::none, 0), "");
  EXPECT_NE(fault_with(Datum::shift, 0).find("control has 0 points in plan and 0 heights, and shift needs 1 and 1"), std::string::npos);
  EXPECT_NE(fault_with(Datum::similarity, 0).find("similarity needs 2 and 3"), std::string::npos);
  EXPECT_NE(fault_with(Datum::shift, 2, ImageValues::start).find("no station is observed"), std::string::npos);
  core::Value both = io::read_value_file(file);
  both["drift"] = core::Value("block");
  both["datum"] = core::Value("shift");
  try {
    read_block_config(file, both);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.text().find("the shift of a drift is that of the datum"), std::string::npos) << e.text();
  }
}

}  // namespace
}  // namespace swath::calib
