// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/images/image_list.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

class ImageList : public testing::Test {
 protected:
  std::vector<ListedImage> read(const std::string& text, const ImageListFile& f = {}) {
    test::write_bytes(folder / "list.csv", text);
    return read_listed_images(folder / "list.csv", f);
  }
  std::string fault_of(const std::string& text) {
    try {
      read(text);
    } catch (const core::Error& e) {
      return e.text();
    }
    return {};
  }
  const test::TemporaryFolder folder;
};

TEST_F(ImageList, RowsWithAndWithoutCameraAndStrip) {
  const auto plain = read("name,event\nDSC 1.jpg,17\nDSC 2.jpg,18\n");
  ASSERT_EQ(plain.size(), 2u);
  EXPECT_EQ(plain[1].name + "/" + plain[1].event, "DSC 2.jpg/18");
  EXPECT_FALSE(plain[0].camera || plain[0].strip);
  EXPECT_TRUE(plain[0].place.ends_with("list.csv:2"));
  ImageListFile f;
  f.name = "photo", f.event = "feature", f.camera = "body", f.strip = "run";
  const auto full = read("run,body,photo,feature\n3,left,a,1\n", f);
  EXPECT_EQ(*full[0].camera, "left");
  EXPECT_EQ(*full[0].strip, 3);
  const auto some = read("name,event,camera,strip\na,1,left,3\nb,2,,\n");
  EXPECT_TRUE(some[0].camera && some[0].strip);
  EXPECT_FALSE(some[1].camera || some[1].strip) << "as without the column";
}

TEST_F(ImageList, WhatIsMissingIsNamed) {
  EXPECT_NE(fault_of("name,id\na,1\n").find("event"), std::string::npos);
  EXPECT_NE(fault_of("name,event\na,1\nb,\n").find("list.csv:3"), std::string::npos);
  EXPECT_NE(fault_of("name,event\na,1\nb,\n").find("image b names no event"), std::string::npos);
  EXPECT_NE(fault_of("name,event\n,1\n").find("the image has no name in column 'name'"), std::string::npos);
  EXPECT_NE(fault_of("name,event,strip\na,1,2.5\n").find("the strip is not a whole number: 2.5"), std::string::npos);
}

}  // namespace
}  // namespace swath::io
