// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>

namespace swath::pipeline {

/// By the clock, and of the processors, s.
struct TimeSpent {
  double seconds = 0.0, processor = 0.0;
  TimeSpent& operator+=(const TimeSpent& o) {
    seconds += o.seconds, processor += o.processor;
    return *this;
  }
};

/// Whose processor time counts: that of the thread that asks, or that of all threads of the program.
enum class Whose { thread, program };

class Stopwatch {
 public:
  explicit Stopwatch(Whose whose);
  /// Since it was made. A thread's watch is read by that thread.
  TimeSpent spent() const;

 private:
  Whose whose_;
  std::chrono::steady_clock::time_point start_;
  double processor_;
};

}  // namespace swath::pipeline
