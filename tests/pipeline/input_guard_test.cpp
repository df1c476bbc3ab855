// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/input_guard.h"

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

class Guard : public ::testing::Test {
 protected:
  Guard() {
    test::write_bytes(folder_ / "survey/trajectory.csv", "t");
    test::write_bytes(folder_ / "survey/points/cloud.laz", "c");
  }
  bool refused(const fs::path& product) const {
    try {
      InputGuard({folder_ / "survey/trajectory.csv", folder_ / "survey/points/cloud.laz"}).expect_apart(folder_.path() / product);
      return false;
    } catch (const core::Error& e) {
      EXPECT_EQ(e.code(), core::Exit::bad_usage);
      return true;
    }
  }
  test::TemporaryFolder folder_;
};

TEST_F(Guard, AFileAndAFolderOfInputsAreRefusedByName) {
  EXPECT_TRUE(refused("survey/trajectory.csv"));
  EXPECT_TRUE(refused("survey/points"));
  EXPECT_TRUE(refused("survey/../survey/./points"));
  EXPECT_FALSE(refused("survey/dtm"));
  EXPECT_FALSE(refused("survey/point"));
  EXPECT_FALSE(refused("out/trajectory.csv"));
}

TEST_F(Guard, AFolderWhoseNameBeginsAnothersIsApart) {
  test::write_bytes(folder_ / "survey/points.old/cloud.laz", "o");
  test::write_bytes(folder_ / "survey/points-2/cloud.laz", "p");
  const InputGuard guard({folder_ / "survey/points.old/cloud.laz", folder_ / "survey/points-2/cloud.laz"});
  EXPECT_NO_THROW(guard.expect_apart(folder_ / "survey/points"));
  EXPECT_THROW(guard.expect_apart(folder_ / "survey/points-2"), core::Error);
  EXPECT_THROW(guard.expect_apart(folder_ / "survey/points.old/cloud.laz"), core::Error);
  EXPECT_THROW(guard.expect_apart(folder_ / "survey"), core::Error);
}

TEST_F(Guard, LinksOfEitherKindAreSeenThrough) {
  fs::create_directories(folder_ / "out/dtm");
  fs::create_symlink("../survey/trajectory.csv", folder_ / "out/trajectory.csv");
  EXPECT_TRUE(refused("out/trajectory.csv"));
  fs::create_hard_link(folder_ / "survey/trajectory.csv", folder_ / "out/hard.csv");
  EXPECT_TRUE(refused("out/hard.csv"));
  fs::create_directory_symlink("../survey/points", folder_ / "out/points");
  EXPECT_TRUE(refused("out/points"));
  fs::create_directory_symlink("survey", folder_ / "again");
  EXPECT_TRUE(refused("again/trajectory.csv"));
  EXPECT_FALSE(refused("out/dtm"));
  fs::create_hard_link(folder_ / "survey/points/cloud.laz", folder_ / "out/dtm/a.tif");
  EXPECT_TRUE(refused("out/dtm")) << "a hard link within a folder of products";
}

}  // namespace
}  // namespace swath::pipeline
