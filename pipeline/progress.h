// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "core/error.h"

namespace swath::pipeline {

/// A run was stopped from outside. As where the disk is full, work done so far stays valid.
class Interrupted : public core::SystemError {
 public:
  Interrupted() : core::SystemError("the run was interrupted", "", "the same command goes on from what is done") {}
};

/// How a run reports on standard error.
enum class Voice { bar, lines, quiet, json };

/// Progress of one step of a run after another. Thread-safe.
class Progress {
 public:
  /// `bar` falls back to `lines` where standard error is not a terminal.
  explicit Progress(Voice voice);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// The steps that are still to begin, each with its expected time in any common unit, 0 where nothing is known: the time left of the run
  /// is judged by them and by how long the work done so far took.
  void expect(std::vector<double> steps);

  /// `total`: of what advance() counts, for the rate; 0 for a step that counts nothing and of which only share() may say how far it is.
  /// `work`: sum of the work of its pieces, in any unit, where the counts do not say how far the step is; 0: the counts do.
  void begin(const std::string& what, std::uint64_t total, const std::string& unit, double work = 0.0);
  void advance(std::uint64_t n, double work = 0.0);
  /// As advance(), for what an earlier run has done: it says nothing of the rate.
  void skip(std::uint64_t n, double work = 0.0);
  /// Of a step without a total: how far it is, 0 to 1, and what it is at (may be empty).
  void share(double done, std::string_view now = {});
  void end();
  /// A line for the person (not when quiet).
  void say(const std::string& text);
  /// From any thread: the next begin(), advance(), skip() or share() throws Interrupted, which ends the run.
  void stop() { stopped_ = true; }

 private:
  using Clock = std::chrono::steady_clock;
  /// Expected time left, s; negative where nothing says it.
  struct Left {
    double step = -1.0, run = -1.0;
  };
  double seconds() const;
  double done_share() const;
  Left left() const;
  void show(bool last);
  void show_text(bool last);
  void show_json(bool last);
  void count(std::uint64_t n, double work, bool skipped);
  void tick();
  void expect_wanted() const {
    if (stopped_) throw Interrupted();
  }

  Voice voice_;
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;
  std::string what_, unit_, now_;
  std::uint64_t total_ = 0, done_ = 0, skipped_ = 0;
  double work_ = 0.0, work_done_ = 0.0, work_skipped_ = 0.0;
  double share_ = -1.0, share_seconds_ = 0.0;  ///< what share() said last, and when, s from the step's begin
  std::vector<double> expected_;               ///< of the steps to come
  double expected_now_ = 0.0;                  ///< of the step at work
  double spent_ = 0.0, spent_expected_ = 0.0;  ///< s on the steps done, and what was expected of them
  size_t begun_ = 0, steps_ = 0;
  Clock::time_point began_, shown_;
  bool open_ = false, ending_ = false;
  std::condition_variable wake_;
  std::thread ticker_;  ///< so that a step that does not count is seen to be at work
};

/// "1 m 12 s", "3.4 s".
std::string duration_text(double seconds);
/// "12.3 M", "840".
std::string count_text(double n);

}  // namespace swath::pipeline
