// SPDX-License-Identifier: GPL-3.0-or-later
// A web server for this machine's own browser: one page, its columns, and the files of one folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/view/packed.h"

namespace swath::tools {

/// What is served: the page at /, blobs under /scene/NAME, clouds under /cloud/NUMBER, and files that lie in `folder` under /files/PATH;
/// files with byte ranges.
struct Served {
  std::string page;
  std::vector<Blob> blobs;
  std::vector<std::filesystem::path> clouds{};
  std::filesystem::path folder{};  ///< empty: no files
};

/// The file that a request's path means; empty where it leads out of the folder (also through links), to something hidden, or to no file.
std::filesystem::path file_within(const std::filesystem::path& folder, const std::string& path);

/// Serves on 127.0.0.1 until the process is interrupted (Ctrl-C) or asked to end. `port` 0: any that is free. `prepare`: called once the
/// port is held; `ready`: with the address once requests are answered. Throws core::usage_error where the port is in use.
void serve(int port, const std::function<Served()>& prepare, const std::function<void(const std::string&)>& ready);

}  // namespace swath::tools
