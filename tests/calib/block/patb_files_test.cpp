// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/patb_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/geo/frames.h"
#include "io/images/image_file.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

const std::vector<PatbPhoto> photos{{"4001", 153.012, {612345.678, 5345678.901, 1234.5}, core::exp_so3({0.01, -0.02, 1.5})},
                                    {"4002", 153.012, {612845.678, 5345678.901, 1235.5}, core::exp_so3({0.02, 0.01, -3.1})}};
const std::vector<std::string> points{"17", "t 18"};

std::vector<std::string> names_of(const std::vector<PatbPhoto>& of) {
  std::vector<std::string> out;
  for (const PatbPhoto& p : of) out.push_back(p.name);
  return out;
}

TEST(PatbFiles, ImageCoordinatesReadBack) {
  const std::vector<std::string> numbered = patb_names(points);
  EXPECT_EQ(numbered, (std::vector<std::string>{"1", "2"}));  // a blank would end a name
  const test::TemporaryFolder folder;
  std::ofstream(folder / "block.im") << patb_image_coordinates(photos, names_of(photos), numbered,
                                                               {{1, 0, -12.3456789, 45.678}, {0, 1, 0.5, -0.25}, {1, 1, 60.0, 70.0}});
  io::ImageFile f;
  f.file = folder / "block.im", f.format = io::ImageFormat::patb;
  f.unit = io::ImageUnit::um, f.y = io::ImageY::up, f.origin = io::ImageOrigin::middle;
  const io::ImageData d = io::read_image_file(f);
  EXPECT_EQ(d.images, (std::vector<std::string>{"4001", "4002"}));
  EXPECT_EQ(d.points, (std::vector<std::string>{"2", "1"}));
  ASSERT_EQ(d.marks.size(), 3u);
  EXPECT_EQ(d.marks[1].image, 1u);
  EXPECT_NEAR(d.marks[1].x, -12345.6789, 1e-4);  // um
  EXPECT_NEAR(d.marks[1].y, 45678.0, 1e-4);
  EXPECT_NEAR(d.marks[0].y, -250.0, 1e-4);
}

/// By the columns of the format: 16 characters each.
TEST(PatbFiles, OrientationsHaveTheirColumns) {
  const std::string text = patb_orientations(photos, names_of(photos));
  std::vector<std::string> lines;
  for (size_t at = 0; at < text.size();) {
    const size_t end = text.find('\n', at);
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  ASSERT_EQ(lines.size(), 6u);
  for (size_t p = 0; p < 2; ++p) {
    const auto number = [&](size_t line, size_t column) { return std::stod(lines[3 * p + line].substr(16 * column, 16)); };
    EXPECT_EQ(lines[3 * p].size(), 80u);
    EXPECT_EQ(lines[3 * p + 1].size(), 80u);
    EXPECT_EQ(lines[3 * p + 2].size(), 64u);
    EXPECT_EQ(static_cast<int>(number(0, 0)), p == 0 ? 4001 : 4002);
    for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(number(0, 2 + k), photos[p].map[static_cast<int>(k)], 5e-6);
    for (size_t k = 0; k < 9; ++k)
      EXPECT_NEAR(number(k < 5 ? 1 : 2, k < 5 ? k : k - 5), photos[p].grid_R_camera(static_cast<int>(k / 3), static_cast<int>(k % 3)),
                  5e-13);
  }
}

TEST(PatbFiles, NamesThatPatbCannotHaveAreNumbers) {
  EXPECT_EQ(patb_names({"a", "b.jpg"}), (std::vector<std::string>{"a", "b.jpg"}));
  EXPECT_EQ(patb_names({"a", "-99"}), (std::vector<std::string>{"1", "2"}));
  EXPECT_EQ(patb_names({"a_name_of_sixteen"}), (std::vector<std::string>{"1"}));
  EXPECT_EQ(patb_name_table({"a"}, {"a"}, {"p"}, {"p"}), "");
  EXPECT_EQ(patb_name_table({"a"}, {"a"}, points, {"1", "2"}), "kind,patb,name\npoint,1,17\npoint,2,t 18\n");
}

}  // namespace
}  // namespace swath::calib
