// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

namespace swath::pipeline {

/// How a run tells of itself on standard error.
enum class Voice { bar, lines, quiet, json };

/// Progress of one stage after another. Thread-safe.
class Progress {
 public:
  /// `bar` falls back to `lines` where standard error is no terminal.
  explicit Progress(Voice voice);
  ~Progress();

  void begin(const std::string& what, std::uint64_t total, const std::string& unit);
  void advance(std::uint64_t n);
  void end();
  /// A line for the person (not when quiet).
  void say(const std::string& text);

 private:
  void show(bool last);
  Voice voice_;
  std::mutex mutex_;
  std::string what_, unit_;
  std::uint64_t total_ = 0, done_ = 0;
  std::chrono::steady_clock::time_point began_, shown_;
  bool open_ = false;
};

/// "1 m 12 s", "3.4 s".
std::string duration_text(double seconds);
/// "12.3 M", "840".
std::string count_text(double n);

}  // namespace swath::pipeline
