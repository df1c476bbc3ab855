// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/hangar/refusals.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace swath::calib {
namespace {

template <class R>
std::string fault(const R& what) {
  try {
    if constexpr (std::is_same_v<R, Resection>)
      refuse(what, "S1", 2, "hangar.toml");
    else
      refuse(what, "roof", "hangar.toml");
  } catch (const core::Error& e) {
    EXPECT_EQ(e.where(), "hangar.toml");
    EXPECT_FALSE(e.hint().empty());
    return e.what();
  }
  return {};
}

TEST(Refusals, OfStationsNameTheCause) {
  Resection r;
  for (const auto& [state, words] : {std::pair{ResectionState::too_few, "station 'S1' has 2 distances"},
                                     {ResectionState::in_line, "lie in one line"},
                                     {ResectionState::weak, "in the plane of its targets"},
                                     {ResectionState::two_fit, "it fits at (1.000, 2.000, 3.500)"},
                                     {ResectionState::not_found, "fits its distances"}}) {
    r.state = state;
    r.position = {1, 2, 3.5};
    EXPECT_NE(fault(r).find(words), std::string::npos) << fault(r);
  }
  r.state = ResectionState::solved;
  EXPECT_EQ(fault(r), "");
}

TEST(Refusals, OfPointsNameTheCause) {
  PointSearch p;
  for (const auto& [state, words] : {std::pair{PointState::too_few, "point 'roof' has too few sights"},
                                     {PointState::not_determined, "fewer than three or lie in one line"},
                                     {PointState::weak, "hardly determine it"},
                                     {PointState::two_fit, "mirrored in the plane of the stations"},
                                     {PointState::not_found, "does not converge"}}) {
    p.state = state;
    EXPECT_NE(fault(p).find(words), std::string::npos) << fault(p);
  }
  p.state = PointState::solved;
  EXPECT_EQ(fault(p), "");
}

}  // namespace
}  // namespace swath::calib
