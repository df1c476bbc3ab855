// SPDX-License-Identifier: GPL-3.0-or-later
// What is declared is a little more than what is taken (tests/stages/memory_test.cpp); what the allocator rounds up and what nobody counts
// (stacks, file buffers, lists of tiles) has a share of its own.
#include "pipeline/memory.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "core/config/option.h"
#include "core/config/units.h"
#include "core/error.h"
#include "io/raster/geotiff.h"

namespace swath::pipeline {
namespace {

constexpr double uncounted = 0.05;  // of the budget
constexpr double megabyte = 1e6;
constexpr double plenty = 2e9;  // bytes: with a budget of so many, freed memory is kept for what comes next

/// Resident pages of the process, in bytes, and those of them that are mapped files; 0 where the system does not say.
struct Resident {
  std::uint64_t all = 0, files = 0;
};

Resident resident() {
  std::ifstream in("/proc/self/statm");
  std::uint64_t size = 0;
  Resident r;
  if (!(in >> size >> r.all >> r.files)) return {};
  const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  return {r.all * page, r.files * page};
}

/// What the process holds without the freed memory that the allocator keeps.
std::uint64_t held_bytes() {
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
  const Resident now = resident();
  const struct mallinfo2 heap = mallinfo2();
  // At least what is resident and not free in this heap: other allocators' memory and stacks are in that.
  const std::uint64_t least = now.all - std::min<std::uint64_t>(now.all, heap.fordblks);
  return std::min<std::uint64_t>(now.all, std::max<std::uint64_t>(least, now.files + heap.uordblks + heap.hblkhd));
#else
  return_freed_memory();
  return resident_bytes();
#endif
}

}  // namespace

std::uint64_t resident_bytes() { return resident().all; }

void return_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

void fit_memory(double bytes) {
#ifdef __GLIBC__
  // Larger pieces are fetched from the system and go back at once: slower (a fifth of the time at 2 GB), but nothing of them is kept.
  constexpr double share = 1.0 / 256.0;
  if (bytes < plenty) {
    mallopt(M_MMAP_THRESHOLD, static_cast<int>(std::max(256e3, bytes * share)));
    mallopt(M_TRIM_THRESHOLD, static_cast<int>(bytes * share));
    mallopt(M_ARENA_MAX, 1);
  }
#endif
  io::limit_raster_cache(static_cast<std::int64_t>(bytes / 32.0));
}

double MemoryBudget::free() const { return std::max(0.0, left()); }

double MemoryBudget::left() const {
  const double most = (1.0 - uncounted) * bytes_;
  // Pages that were returned must be fetched and cleared again: freed memory is kept where the reserve has room for all of it.
  if (bytes_ >= plenty) {
    const auto held = static_cast<double>(held_bytes());
    if (static_cast<double>(resident_bytes()) - held <= reserve()) return most - held;
  }
  return_freed_memory();
  return most - static_cast<double>(resident_bytes());
}

double MemoryBudget::reserve() const { return uncounted * bytes_; }

void MemoryBudget::make_room(std::uint64_t bytes) const {
  if (static_cast<double>(resident_bytes() + bytes) > bytes_) return_freed_memory();
}

void MemoryBudget::require(double bytes, double left, std::string_view what, bool about) const {
  if (bytes <= left) return;
  const auto text = [](double b) { return core::format_quantity(core::Dimension::memory, std::ceil(b / megabyte) * megabyte); };
  const double works = bytes_ + (bytes - left) / (1.0 - uncounted);
  throw TooLittleMemory("run.memory = " + text(bytes_) + " is too little: " + std::string(what) + " needs " + text(bytes) + " and " +
                            text(std::max(0.0, left)) + " are free",
                        "run.memory",
                        "--set run.memory=\"" + text(works) + "\" " +
                            (about ? "is about the least that works here" : "is the least that works here; what is finished is kept"),
                        core::Exit::bad_usage);
}

}  // namespace swath::pipeline
