// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/delivery.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <vector>

#include "io/output_file.h"
#include "io/value_file.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* list_name = "tiles.json";

bool is_temporary(const fs::path& file) { return file.filename().string().starts_with(".part-"); }

std::vector<std::string> listed(const fs::path& list) {
  std::vector<std::string> out;
  if (!fs::exists(list)) return out;
  const core::Value names = io::read_value_file(list);
  if (names.is_array())
    for (const core::Value& name : names.items())
      if (name.is_text()) out.push_back(name.as_text());
  return out;
}

/// One name per file: only one run works in an output folder, and a temporary file left by a kill is written over.
void deliver_file(const fs::path& from, const fs::path& to, bool keep) {
  const fs::path temporary = to.parent_path() / (".part-" + to.filename().string());
  std::error_code ec;
  fs::create_directories(to.parent_path(), ec);
  if (ec) io::throw_system_error("cannot make the folder of the output", to, ec.value());
  fs::remove(temporary, ec);
  if (fs::equivalent(from, to, ec)) return;
  if (!keep) fs::create_hard_link(from, temporary, ec);
  if (keep || ec) {
    fs::copy_file(from, temporary, fs::copy_options::overwrite_existing, ec);
    if (ec) {
      const int code = ec.value();
      fs::remove(temporary, ec);
      io::throw_system_error("cannot write", to, code);
    }
  }
  fs::rename(temporary, to, ec);
  if (ec) io::throw_system_error("cannot finish", to, ec.value());
}

}  // namespace

void deliver(const fs::path& made, const fs::path& output, bool keep) {
  if (!fs::exists(made)) return;
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(made))
    if (entry.is_regular_file() && !is_temporary(entry.path())) files.push_back(fs::relative(entry.path(), made));
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files)
    if (file.filename() != list_name) deliver_file(made / file, output / file, keep);
  for (const fs::path& file : files) {
    if (file.filename() != list_name) continue;
    const std::vector<std::string> now = listed(made / file);
    for (const std::string& old : listed(output / file))
      if (std::find(now.begin(), now.end(), old) == now.end()) {
        std::error_code ignored;
        fs::remove((output / file).parent_path() / fs::path(old).filename(), ignored);
      }
    deliver_file(made / file, output / file, keep);
  }
}

void discard(const fs::path& folder, const fs::path& as) {
  std::error_code ignored;
  fs::remove_all(as, ignored);
  fs::rename(folder, as, ignored);
  fs::remove_all(as, ignored);
}

void remove_temporary_files(const fs::path& folder) {
  std::error_code ec;
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder, ec))
    if (entry.is_regular_file() && is_temporary(entry.path())) files.push_back(entry.path());
  for (const fs::path& file : files) fs::remove(file, ec);
}

}  // namespace swath::pipeline
