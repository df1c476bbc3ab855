// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace swath::io {

/// The program as it would be started: a name with a slash as it is, another looked up on PATH. Empty where there is none that may be run.
std::filesystem::path find_program(const std::filesystem::path& program);

/// How a program ended: by itself with a code, or by a signal.
struct ProcessEnd {
  int code = 0;           ///< 0 to 255; -1 where a signal ended it
  int signal = 0;         ///< 0: none
  bool too_long = false;  ///< it was ended at its time limit

  bool well() const { return code == 0 && signal == 0; }
  /// "exit code 3", "signal 11 (Segmentation fault)", "its time limit".
  std::string text() const;
};

/// Runs a program to its end, without a shell: working folder `folder`, nothing to read, what it writes goes to `log`. It is ended where it
/// takes longer than `limit` (s; 0: no limit), with all that it has started; if this program ends, it ends too (what it has started may
/// not). Throws Error where it cannot be started.
ProcessEnd run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                       const std::filesystem::path& log, double limit = 0);

}  // namespace swath::io
