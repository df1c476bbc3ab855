// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/drawing_file.h"

#include "core/error.h"
#include "io/raster/png.h"
#include "io/text/value_file.h"
#include "tests/world/support.h"

namespace swath::stages {
namespace {

TEST(DrawingFile, TheEndingDecides) {
  const test::TemporaryFolder folder;
  const report::Drawing drawing{60, 40, [](report::Canvas& c) { c.fill({0, 0, 60, 40}, {10, 20, 30}); }};
  for (const char* name : {"a.png", "a.svg", "a.pdf"}) {
    EXPECT_TRUE(names_drawing(name));
    write_drawing(folder / name, drawing);
  }
  EXPECT_EQ(io::read_png(folder / "a.png").at(5, 5)[2], 30);
  EXPECT_TRUE(io::read_text_file(folder / "a.svg").starts_with("<svg"));
  EXPECT_TRUE(io::read_text_file(folder / "a.pdf").starts_with("%PDF"));
  for (const char* name : {"a.jpg", "a", "png"}) {
    EXPECT_FALSE(names_drawing(name));
    EXPECT_THROW(write_drawing(folder / name, drawing), core::Error);
  }
}

}  // namespace
}  // namespace swath::stages
