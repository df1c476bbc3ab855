// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/delayed_library.h"

#include <dlfcn.h>

#include <atomic>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "core/error.h"

namespace swath::io {
namespace {

[[noreturn]] void refuse_library(const std::string& library) {
  const char* why = dlerror();
  throw core::Error("cannot be loaded" + (why ? ": " + std::string(why) : std::string()), library,
                    "install the package that holds it, or give its folder in LD_LIBRARY_PATH");
}

/// Functions of the library by name. The library stays loaded to the end of the program.
std::vector<void*> functions_of(const char* library, const char* const* names, std::size_t count) {
  void* handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
  if (!handle) refuse_library(library);
  std::vector<void*> found(count);
  for (std::size_t k = 0; k < count; ++k)
    if (!(found[k] = dlsym(handle, names[k]))) refuse_library(library);
  return found;
}

}  // namespace
}  // namespace swath::io

void swath_load_delayed(const char* library, const char* const* names, void** slots, std::size_t count) {
  static std::mutex mutex;
  static std::set<void**> filled;
  const std::scoped_lock lock(mutex);
  if (filled.contains(slots)) return;
  const std::vector<void*> found = swath::io::functions_of(library, names, count);
  // Another thread reads a slot while it is written: a whole pointer at a time, the old one or the new.
  for (std::size_t k = 0; k < count; ++k) std::atomic_ref(slots[k]).store(found[k], std::memory_order_release);
  filled.insert(slots);
}
