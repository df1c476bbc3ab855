// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/time_spent.h"

#include <gtest/gtest.h>

#include <thread>

namespace swath::pipeline {
namespace {

/// Computes until the thread's processor has worked for `seconds`.
void work(double seconds) {
  const Stopwatch watch(Whose::thread);
  while (watch.spent().processor < seconds) {
  }
}

TEST(TimeSpent, WaitingTakesNoProcessor) {
  const Stopwatch watch(Whose::thread);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_GE(watch.spent().seconds, 0.05);
  EXPECT_LT(watch.spent().processor, 0.04);
}

TEST(TimeSpent, WorkOfOtherThreadsIsTheProgramsAlone) {
  const Stopwatch thread(Whose::thread), program(Whose::program);
  std::thread([] { work(0.05); }).join();
  EXPECT_LT(thread.spent().processor, 0.04);
  EXPECT_GE(program.spent().processor, 0.05);
}

TEST(TimeSpent, AddsUp) {
  TimeSpent sum{1.0, 0.5};
  sum += {2.0, 0.25};
  EXPECT_EQ(sum.seconds, 3.0);
  EXPECT_EQ(sum.processor, 0.75);
}

}  // namespace
}  // namespace swath::pipeline
