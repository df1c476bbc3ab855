// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <mutex>

namespace swath::pipeline {

/// Admits work while the sum of what it asks for stays within a budget; one piece alone is always admitted.
class MemoryGate {
 public:
  explicit MemoryGate(std::uint64_t budget) : budget_(budget) {}

  class Pass {
   public:
    Pass(MemoryGate& gate, std::uint64_t bytes) : gate_(gate), bytes_(bytes) {
      std::unique_lock lock(gate_.mutex_);
      gate_.free_.wait(lock, [&] { return gate_.used_ == 0 || gate_.used_ + bytes_ <= gate_.budget_; });
      gate_.used_ += bytes_;
      gate_.most_ = std::max(gate_.most_, gate_.used_);
    }
    ~Pass() {
      {
        const std::lock_guard lock(gate_.mutex_);
        gate_.used_ -= bytes_;
      }
      gate_.free_.notify_all();
    }
    Pass(const Pass&) = delete;
    Pass& operator=(const Pass&) = delete;

   private:
    MemoryGate& gate_;
    std::uint64_t bytes_;
  };

  std::uint64_t most() const { return most_; }

 private:
  std::uint64_t budget_, used_ = 0, most_ = 0;
  std::mutex mutex_;
  std::condition_variable free_;
};

}  // namespace swath::pipeline
