// SPDX-License-Identifier: GPL-3.0-or-later
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <thread>

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <poll.h>
#include <unistd.h>

#include "core/error.h"
#include "core/printable.h"
#include "pipeline/jobs/config_folder.h"
#include "tools/command.h"
#include "tools/program.h"

namespace {

/// Columns and grids of one tile are freed as those of the next are made: pages kept need not be fetched and cleared again. One arena for
/// all threads of a small machine, so that what one has freed serves the others and hardly more is held than was needed at once.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_ARENA_MAX, static_cast<int>(1 + std::thread::hardware_concurrency() / 4));
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most that glibc takes
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
#endif
}

/// Archives of the program bring the charts' typeface with them, in share/swath/fonts: fontconfig is pointed to it.
void use_own_typeface() {
  const std::filesystem::path fonts = swath::pipeline::program_folder() / "../share/swath/fonts/fonts.conf";
  std::error_code ec;
  if (std::filesystem::exists(fonts, ec)) setenv("FONTCONFIG_FILE", fonts.lexically_normal().c_str(), 0);
}

/// Whether the standard output is a pipe whose reader has gone, as that of `| head`: what it did not want is no fault.
bool is_reader_gone() {
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  return poll(&out, 1, 0) == 1 && (out.revents & (POLLERR | POLLHUP));
}

}  // namespace

int swath_program(int argc, char** argv) {
  // Writing past a limit fails like a full disk, with its error, and does not kill.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  keep_freed_memory();
  use_own_typeface();
  try {
    swath::tools::Commands commands;
    swath::tools::add_demo_command(commands);
    swath::tools::add_job_commands(commands);
    swath::tools::add_init_command(commands);
    swath::tools::add_pipeline_commands(commands);
    swath::tools::add_list_commands(commands);
    swath::tools::add_plan_command(commands);
    swath::tools::add_task_commands(commands);
    swath::tools::add_budget_command(commands);
    swath::tools::add_block_command(commands);
    swath::tools::add_block_theory_command(commands);
    swath::tools::add_block_drift_command(commands);
    swath::tools::add_undistort_command(commands);
    swath::tools::add_simulate_command(commands);
    swath::tools::add_info_command(commands);
    swath::tools::add_volumes_command(commands);
    swath::tools::add_profile_command(commands);
    swath::tools::add_map_terrain_command(commands);
    swath::tools::add_view_command(commands);
    swath::tools::add_completion_commands(commands);
    swath::tools::add_docs_command(commands);
    const int code = commands.call(argc, argv);
    errno = 0;
    if (const bool failed = std::fflush(stdout) != 0; failed || std::ferror(stdout) != 0) {
      if (errno == EPIPE || is_reader_gone()) return code;
      const std::string why = failed && errno ? std::string(": ") + std::strerror(errno) : "";
      throw swath::core::Error("cannot write to the standard output" + why, "", errno == ENOSPC ? "the disk is full" : "");
    }
    return code;
  } catch (const swath::core::Error& e) {
    std::fprintf(stderr, "swath: error: %s\n", swath::core::printable(swath::core::shortened(e.text())).c_str());
    return static_cast<int>(e.code());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "swath: error: out of memory\n  hint: a smaller run.memory or run.tile needs less\n");
    return static_cast<int>(swath::core::Exit::bad_data);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "swath: error: %s\n", swath::core::printable(swath::core::shortened(e.what())).c_str());
    return static_cast<int>(swath::core::Exit::bad_data);
  }
}
