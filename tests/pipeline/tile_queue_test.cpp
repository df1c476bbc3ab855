// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/tile_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace swath::pipeline {
namespace {

TEST(TileQueue, LargestThatFitsComesFirst) {
  TileQueue queue({10, 70, 50, 30}, 100);
  {
    const TileQueue::Piece first = queue.take();
    EXPECT_EQ(first.number(), 1u);
    const TileQueue::Piece second = queue.take();  // 50 would pass the budget
    EXPECT_EQ(second.number(), 3u);
  }
  EXPECT_EQ(queue.take().number(), 2u);
  EXPECT_EQ(queue.take().number(), 0u);
}

TEST(TileQueue, OnePieceAloneMayPassTheBudget) {
  TileQueue queue({500, 600}, 100);
  EXPECT_EQ(queue.take().number(), 1u);
  EXPECT_EQ(queue.take().number(), 0u);
}

TEST(TileQueue, ThreadsTakeEachPieceOnceWithinTheBudget) {
  constexpr std::uint64_t budget = 100;
  std::vector<std::uint64_t> bytes;
  for (std::uint64_t i = 0; i < 400; ++i) bytes.push_back(1 + i * 37 % 60);
  TileQueue queue(bytes, budget);
  std::atomic<std::uint64_t> used{0}, most{0};
  std::vector<std::atomic<int>> taken(bytes.size());
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int k = 0; k < 100; ++k) {
        const TileQueue::Piece piece = queue.take();
        const std::uint64_t now = used += bytes[piece.number()];
        for (std::uint64_t seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
        }
        ++taken[piece.number()];
        std::this_thread::yield();
        used -= bytes[piece.number()];
      }
    });
  for (std::thread& t : threads) t.join();
  EXPECT_LE(most, budget);
  for (const auto& n : taken) EXPECT_EQ(n, 1);
}

}  // namespace
}  // namespace swath::pipeline
