// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/delayed_library.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <thread>
#include <vector>

#include "core/error.h"

namespace {

using Function = double (*)(double);

TEST(DelayedLibrary, SlotsBecomeTheFunctionsHoweverManyThreadsCall) {
  constexpr std::array names{"cos", "sin"};
  std::array<void*, 2> slots{};
  std::vector<std::thread> threads;
  for (int k = 0; k < 8; ++k) threads.emplace_back([&] { swath_load_delayed("libm.so.6", names.data(), slots.data(), names.size()); });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(reinterpret_cast<Function>(slots[0])(1.0), std::cos(1.0));
  EXPECT_EQ(reinterpret_cast<Function>(slots[1])(1.0), std::sin(1.0));
}

TEST(DelayedLibrary, ALibraryOrAFunctionThatIsNotThereIsNamed) {
  constexpr std::array names{"cos", "swath_has_no_such_function"};
  std::array<void*, 2> slots{};
  const auto fault = [&](const char* library) {
    try {
      swath_load_delayed(library, names.data(), slots.data(), names.size());
    } catch (const swath::core::Error& e) {
      return e.text();
    }
    return std::string();
  };
  EXPECT_NE(fault("libswath_is_not_there.so.1").find("libswath_is_not_there.so.1: cannot be loaded"), std::string::npos);
  EXPECT_NE(fault("libm.so.6").find("swath_has_no_such_function"), std::string::npos);
  EXPECT_EQ(slots[0], nullptr) << "a slot was filled though another cannot be";
}

}  // namespace
