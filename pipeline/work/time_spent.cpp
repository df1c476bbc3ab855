// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/time_spent.h"

#include <ctime>

namespace swath::pipeline {
namespace {

/// Processor time so far, s.
double processor_time(Whose whose) {
  timespec t{};
  clock_gettime(whose == Whose::thread ? CLOCK_THREAD_CPUTIME_ID : CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

Stopwatch::Stopwatch(Whose whose) : whose_(whose), start_(std::chrono::steady_clock::now()), processor_(processor_time(whose)) {}

TimeSpent Stopwatch::spent() const {
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(), processor_time(whose_) - processor_};
}

}  // namespace swath::pipeline
