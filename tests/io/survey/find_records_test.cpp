// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/find_records.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "core/error.h"
#include "io/survey/proposal.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;

TEST(FindRecords, AFolderThatIsNotThere) { EXPECT_THROW(find_records("no/such/folder"), core::Error); }

TEST(FindRecords, WhatCannotBeReadIsNamedAndTheRestIsProposed) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.pos", "% GPST latitude(deg) longitude(deg) height(m) Q ns\n");
  test::write_bytes(folder / "cut.las", "LASF");
  test::write_bytes(folder / "empty.csv", "");
  test::write_bytes(folder / "laser.csv", "gps_sow_s,range_m\n474009,500.1\n474010,500.2\n");
  fs::create_symlink("nothing.laz", folder / "linked.laz");
  fs::create_directory_symlink(".", folder / "itself");
  ASSERT_EQ(::mkfifo((folder / "pipe.csv").c_str(), 0600), 0);
  const auto found = find_records(folder.path());
  ASSERT_EQ(found.size(), 6u) << "a link to a folder is passed over";
  const Proposal p = propose_survey(found, "odd");
  EXPECT_NE(p.toml.find("[[laser]]\nfile = \"laser.csv\""), std::string::npos) << p.toml;
  EXPECT_NE(p.toml.find("cut.las: cannot be read: "), std::string::npos) << p.toml;
  EXPECT_NE(p.toml.find("empty.csv: cannot be read: the file is empty"), std::string::npos) << p.toml;
  EXPECT_NE(p.toml.find("linked.laz: cannot be read: the link leads to nothing"), std::string::npos) << p.toml;
  EXPECT_NE(p.toml.find("pipe.csv: cannot be read: it is not a file"), std::string::npos) << p.toml;
}

// Its files would be taken for addresses by the survey that names them.
TEST(FindRecords, AFolderNamedAsASchemeIsPassedOver) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "https:/host");
  test::write_bytes(folder / "https:/host/laser.csv", "gps_sow_s,range_m\n474009,500.1\n474010,500.2\n");
  test::write_bytes(folder / "laser.csv", "gps_sow_s,range_m\n474009,500.1\n474010,500.2\n");
  EXPECT_EQ(find_records(folder.path()).size(), 1u);
}

}  // namespace
}  // namespace swath::io
