// SPDX-License-Identifier: GPL-3.0-or-later
// The budget run.memory against what the process holds: every stage gets what is free when it begins.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/error.h"

namespace swath::pipeline {

/// Resident memory of the process, code and mapped files with it; 0 where the system does not say.
std::uint64_t resident_bytes();

/// Freed memory goes back to the system.
void return_freed_memory();

/// The allocator and GDAL's cache of blocks keep no more than fits a budget of `bytes`. To be called once, at the start of a run.
void fit_memory(double bytes);

/// run.memory is too little, exit code 2. As where the disk is full, work done so far stays valid.
class TooLittleMemory : public core::SystemError {
 public:
  using SystemError::SystemError;
};

class MemoryBudget {
 public:
  explicit MemoryBudget(double bytes) : bytes_(bytes) {}
  double bytes() const { return bytes_; }
  /// Bytes that may be taken beside what the process holds once freed memory is returned.
  double free() const;
  /// The same, below 0 where the process already holds more than the budget allows.
  double left() const;
  /// Of the budget what free() leaves for memory that nobody counts.
  double reserve() const;
  /// Before `bytes` are taken: returns freed memory where they would not fit beside it.
  void make_room(std::uint64_t bytes) const;
  /// Throws TooLittleMemory, "WHAT needs ...", with the budget that works, where `bytes` are more than what is `left`. `about`: as far as
  /// can be known yet.
  void require(double bytes, double left, std::string_view what, bool about = false) const;

 private:
  double bytes_;
};

}  // namespace swath::pipeline
