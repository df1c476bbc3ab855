// SPDX-License-Identifier: GPL-3.0-or-later
// Shared libraries that are loaded when one of their functions is called first (cmake/SwathDelayLoad.cmake).
#pragma once

#include <cstddef>

/// Loads `library` by its name and sets each of the `count` slots to the function of that name. Any number of threads may call; it is done
/// once per array of slots. Throws core::Error where the library or one of its functions is not there.
extern "C" void swath_load_delayed(const char* library, const char* const* names, void** slots, std::size_t count);
