// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace swath::core {

void in_parallel(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& work) {
  const std::size_t parts = (n + grain - 1) / grain;
  if (parts <= 1) {
    if (n > 0) work(0, n);
    return;
  }
  // Isolated: a thread that waits for the last part must not begin another tile meanwhile, which would need memory on top of this one.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, parts, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t k = range.begin(); k < range.end(); ++k) work(k * grain, std::min(n, (k + 1) * grain));
        },
        tbb::simple_partitioner());
  });
}

}  // namespace swath::core
