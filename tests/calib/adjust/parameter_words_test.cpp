// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/parameter_words.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

#include "core/config/units.h"

namespace swath::calib {
namespace {

TEST(ParameterWords, EachParameterHasItsOwn) {
  std::set<std::string_view> keys, names;
  for (int k = boresight_roll; k <= latency; ++k) {
    const ParameterWords& w = words_of(static_cast<Parameter>(k));
    keys.insert(w.key);
    names.insert(w.name);
    EXPECT_GT(w.sigma_size, 0.0) << w.key;
  }
  EXPECT_EQ(keys.size(), static_cast<size_t>(latency) + 1);
  EXPECT_EQ(names.size(), keys.size());
  EXPECT_THROW(words_of(position_north), std::out_of_range);
}

TEST(ParameterWords, StandInTheOrderOfTheParameters) {
  EXPECT_EQ(words_of(boresight_pitch).name, "boresight pitch");
  EXPECT_DOUBLE_EQ(words_of(boresight_heading).sigma_size, core::pi / 180.0 / 3600.0);
  EXPECT_EQ(words_of(lever_down).key, "lever_down");
  EXPECT_EQ(words_of(range_offset).unit, "m");
  EXPECT_EQ(words_of(range_scale).sigma_unit, "ppm");
  EXPECT_EQ(words_of(scan_offset).unit, "rad");
  EXPECT_EQ(words_of(latency).key, "latency");
}

}  // namespace
}  // namespace swath::calib
