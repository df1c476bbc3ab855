// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/other_cloud.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/las/las_header.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(OtherCloud, IsKnownByItsFirstBytes) {
  EXPECT_EQ(other_cloud("ply\nformat ascii 1.0\n"), OtherCloud::ply);
  EXPECT_EQ(other_cloud("ply\r\nformat binary_little_endian 1.0\r\n"), OtherCloud::ply);
  EXPECT_EQ(other_cloud(std::string_view("ASTM-E57\1\0\0\0", 12)), OtherCloud::e57);
  EXPECT_EQ(other_cloud("# .PCD v0.7\n"), OtherCloud::pcd);
  EXPECT_EQ(other_cloud("x;y;z\n500000.1;5300000.2;400.3\n"), OtherCloud::text);
  EXPECT_EQ(other_cloud(""), OtherCloud::none);
  EXPECT_EQ(other_cloud("plywood"), OtherCloud::none);
  EXPECT_EQ(other_cloud(std::string_view("LASX\1\2\n\0", 8)), OtherCloud::none);
}

TEST(OtherCloud, GivenAsACloudItsConversionIsTheHint) {
  const test::TemporaryFolder folder;
  const auto fault = [&](const char* name, const std::string& bytes) {
    test::write_bytes(folder / name, bytes);
    std::vector<std::string> warnings;
    try {
      read_las_header(folder / name, warnings);
    } catch (const core::Error& e) {
      return e.text();
    }
    return std::string();
  };
  const std::string ply = fault("a.ply", "ply\nformat ascii 1.0\nend_header\n1 2 3\n");
  EXPECT_NE(ply.find("not a LAS file: it is a PLY file"), std::string::npos) << ply;
  EXPECT_NE(ply.find("`pdal translate a.ply a.laz`"), std::string::npos) << ply;
  EXPECT_NE(fault("a.e57", "ASTM-E57").find("plugin for E57"), std::string::npos);
  EXPECT_NE(fault("a.xyz", "1 2 3\n4 5 6\n").find("--readers.text.header"), std::string::npos);
  EXPECT_NE(fault("a.bin", std::string(400, '\0')).find("it does not begin with LASF"), std::string::npos);
}

}  // namespace
}  // namespace swath::io
