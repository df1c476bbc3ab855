// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <vector>

namespace swath::pipeline {

/// Hands out pieces of work, the largest first, while the sum of what those at work ask for stays within a budget; one piece alone is
/// always handed out.
class TileQueue {
 public:
  /// `bytes`: what each piece asks for.
  TileQueue(std::vector<std::uint64_t> bytes, std::uint64_t budget);

  /// A piece at work; what it asked for is free again when it goes.
  class Piece {
   public:
    Piece(TileQueue& queue, size_t number) : queue_(queue), number_(number) {}
    ~Piece() { queue_.give_back(number_); }
    Piece(const Piece&) = delete;
    Piece& operator=(const Piece&) = delete;
    size_t number() const { return number_; }

   private:
    TileQueue& queue_;
    size_t number_;
  };

  /// The largest piece left that fits; waits where none does. To be called once for each piece, from any thread.
  Piece take();

 private:
  void give_back(size_t number);

  std::vector<std::uint64_t> bytes_;
  std::vector<size_t> waiting_;  // descending in bytes
  std::uint64_t budget_, used_ = 0;
  std::mutex mutex_;
  std::condition_variable freed_;
};

}  // namespace swath::pipeline
