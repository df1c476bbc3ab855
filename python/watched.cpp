// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/watched.h"

#include <chrono>
#include <exception>
#include <future>
#include <optional>
#include <thread>

namespace swath::python {

namespace nb = nanobind;

void run_watched(const std::function<void()>& work, const std::function<void()>& stop) {
  constexpr std::chrono::milliseconds pause(50);
  std::packaged_task<void()> task(work);
  std::future<void> done = task.get_future();
  std::optional<nb::python_error> raised;
  {
    const nb::gil_scoped_release without_lock;
    std::thread worker(std::move(task));
    while (done.wait_for(pause) == std::future_status::timeout) {
      const nb::gil_scoped_acquire lock;
      if (raised || PyErr_CheckSignals() == 0) continue;
      raised.emplace();
      stop();
    }
    worker.join();
  }
  if (raised) throw std::move(*raised);
  done.get();
}

}  // namespace swath::python
