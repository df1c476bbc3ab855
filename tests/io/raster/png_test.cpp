// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster/png.h"

#include "core/error.h"
#include "tests/io/file_size_limit.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

core::Picture made_picture() {
  core::Picture p(97, 41);
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      std::uint8_t* c = p.at(x, y);
      c[0] = static_cast<std::uint8_t>(x * 2);
      c[1] = static_cast<std::uint8_t>(y * 5);
      c[2] = static_cast<std::uint8_t>((x * y) % 256);
    }
  return p;
}

TEST(Png, ReturnsEveryPixel) {
  const test::TemporaryFolder folder;
  const core::Picture p = made_picture();
  write_png(folder / "a.png", p);
  const core::Picture q = read_png(folder / "a.png");
  EXPECT_EQ(q.width, p.width);
  EXPECT_EQ(q.height, p.height);
  EXPECT_EQ(q.rgb, p.rgb);
  EXPECT_EQ(test::read_bytes(folder / "a.png"), png_bytes(p));
  EXPECT_EQ(png_bytes(p).substr(1, 3), "PNG");
}

TEST(Png, WhatCannotBeWrittenOrReadIsAnError) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(write_png(folder / "a.png", core::Picture()), core::Error);
  core::Picture ragged = made_picture();
  ragged.rgb.pop_back();
  EXPECT_THROW(write_png(folder / "a.png", ragged), core::Error);
  EXPECT_THROW(read_png(folder / "a.png"), core::Error);
  {
    const test::FileSizeLimit limit(100);
    EXPECT_THROW(write_png(folder / "a.png", made_picture()), core::Error);
  }
  EXPECT_EQ(test::entries(folder.path()), 0u);
  const std::string bytes = png_bytes(made_picture());
  test::write_bytes(folder / "cut.png", bytes.substr(0, bytes.size() / 2));
  EXPECT_THROW(read_png(folder / "cut.png"), core::Error);
  test::write_bytes(folder / "text.png", "no picture");
  EXPECT_THROW(read_png(folder / "text.png"), core::Error);
}

}  // namespace
}  // namespace swath::io
