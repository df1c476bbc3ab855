// SPDX-License-Identifier: GPL-3.0-or-later
// Work without Python's lock, in a thread of its own, while the caller's thread looks for Ctrl-C.
#pragma once

#include <nanobind/nanobind.h>

#include <functional>

namespace swath::python {

/// Runs the work and gives its exception on. On a signal whose handler raises (KeyboardInterrupt) `stop` is called, which is to end the
/// work soon; that exception is raised once the work has ended. To be called with Python's lock held.
void run_watched(const std::function<void()>& work, const std::function<void()>& stop);

}  // namespace swath::python
