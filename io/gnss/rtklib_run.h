// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/gnss/rtklib_config.h"

namespace swath::io {

/// One run of rnx2rtkp. Products are `products`/`name`.conf, .pos and .log.
struct RtklibJob {
  std::filesystem::path program;  ///< as find_program gave it
  std::filesystem::path products;
  std::string name;
  std::vector<std::filesystem::path> rover, base, navigation;  ///< `base` empty: the rover alone
  std::optional<std::filesystem::path> antenna_file;
  double time_limit = 0;  ///< s; 0: none
  double every = 0;       ///< s; only epochs at its multiples; 0: all
  RtklibOptions options;
  RtklibSetup setup;  ///< its `antenna_file` is set by run_rtklib
};

/// Writes the configuration and runs the program in a folder of its own beside the products, under short names of its own for all files:
/// RTKLIB expands '*' and '%' in names. Returns the .pos file. Throws Error with the last line of the program's log where the program
/// fails, does not know a value of the configuration, or writes no solution; then only the log and the configuration remain.
std::filesystem::path run_rtklib(const RtklibJob& job);

}  // namespace swath::io
