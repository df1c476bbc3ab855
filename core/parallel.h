// SPDX-License-Identifier: GPL-3.0-or-later
// Loops whose turns do not depend on one another, on all threads of the run.
#pragma once

#include <cstddef>
#include <functional>

namespace swath::core {

/// The largest number of threads that a config or a command may ask for.
inline constexpr int max_threads = 1024;

/// Calls work(first, last) for the parts of 0 to n - 1, `grain` turns each, the last one shorter. The parts are the same for any number of
/// threads, their order is not: no part may read what another writes. Threads that are busy with other tiles are not waited for. An
/// exception of `work` is thrown again.
void in_parallel(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& work);

}  // namespace swath::core
