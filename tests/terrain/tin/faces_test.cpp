// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/faces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace swath::terrain {
namespace {

// Five places on a circle in another order than round it, and beyond its sides faces with the vertex at infinity.
const std::vector<Place> corners{{3, 4}, {-5, 0}, {0, -5}, {5, 0}, {-3, 4}};
const std::vector<std::int32_t> around{0, 4, 1, 2, 3};  // counter-clockwise

/// Cut as a fan from corner `apex` of `around`.
std::vector<Face> pentagon(size_t apex) {
  const auto at = [&](size_t k) { return around[(apex + k) % 5]; };
  std::vector<Face> faces;
  for (size_t k = 1; k < 4; ++k) {
    const auto f = static_cast<std::int32_t>(k - 1), side = static_cast<std::int32_t>(3 + k);
    faces.push_back({{at(0), at(k), at(k + 1)}, {side, k == 3 ? 7 : f + 1, k == 1 ? 3 : f - 1}});
  }
  for (size_t k = 0; k < 5; ++k) {
    const auto f = static_cast<std::int32_t>(3 + k);
    const std::int32_t inner = k == 0 ? 0 : k == 4 ? 2 : static_cast<std::int32_t>(k) - 1;
    faces.push_back({{at(k + 1), at(k), beyond}, {3 + (f - 3 + 4) % 5, 3 + (f - 3 + 1) % 5, inner}});
  }
  return faces;
}

TEST(Faces, APolygonInACircleIsAFanFromItsFirstVertex) {
  for (size_t apex = 0; apex < 5; ++apex) {
    std::vector<Face> faces = pentagon(apex);
    cut_as_fans(faces, corners, {{0, 1}, {1, 2}});
    ASSERT_EQ(faces.size(), 8u);
    for (std::int32_t f = 0; f < 8; ++f) {
      const Face& face = faces[static_cast<size_t>(f)];
      if (face.is_finite()) {
        EXPECT_EQ(std::count(face.v.begin(), face.v.end(), 1), 1) << "corner 1 lies farthest west";
        EXPECT_GT(orientation(corners[static_cast<size_t>(face.v[0])], corners[static_cast<size_t>(face.v[1])],
                              corners[static_cast<size_t>(face.v[2])]),
                  0);
      }
      for (int k = 0; k < 3; ++k) {
        const Face& across = faces[static_cast<size_t>(face.n[static_cast<size_t>(k)])];
        const int back = across.side_of(f);
        EXPECT_EQ(across.n[static_cast<size_t>(back)], f);
        EXPECT_EQ(across.v[static_cast<size_t>(ccw(back))], face.v[static_cast<size_t>(cw(k))]);
        EXPECT_EQ(across.v[static_cast<size_t>(cw(back))], face.v[static_cast<size_t>(ccw(k))]);
      }
    }
  }
}

TEST(Faces, WithoutPairsNothingChanges) {
  std::vector<Face> faces = pentagon(2);
  cut_as_fans(faces, corners, {});
  const std::vector<Face> before = pentagon(2);
  for (size_t f = 0; f < faces.size(); ++f) EXPECT_EQ(faces[f].v, before[f].v);
}

}  // namespace
}  // namespace swath::terrain
