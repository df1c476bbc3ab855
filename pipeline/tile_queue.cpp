// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/tile_queue.h"

#include <algorithm>
#include <numeric>

namespace swath::pipeline {

TileQueue::TileQueue(std::vector<std::uint64_t> bytes, std::uint64_t budget)
    : bytes_(std::move(bytes)), waiting_(bytes_.size()), budget_(budget) {
  std::iota(waiting_.begin(), waiting_.end(), size_t{0});
  std::stable_sort(waiting_.begin(), waiting_.end(), [this](size_t a, size_t b) { return bytes_[a] > bytes_[b]; });
}

TileQueue::Piece TileQueue::take() {
  std::unique_lock lock(mutex_);
  for (;;) {
    const auto fits =
        std::find_if(waiting_.begin(), waiting_.end(), [this](size_t i) { return used_ == 0 || used_ + bytes_[i] <= budget_; });
    if (fits != waiting_.end()) {
      const size_t number = *fits;
      waiting_.erase(fits);
      used_ += bytes_[number];
      return Piece(*this, number);
    }
    freed_.wait(lock);
  }
}

void TileQueue::give_back(size_t number) {
  {
    const std::lock_guard lock(mutex_);
    used_ -= bytes_[number];
  }
  freed_.notify_all();
}

}  // namespace swath::pipeline
