// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/config_folder.h"

#include <algorithm>
#include <cstdlib>

#include "core/config/value.h"
#include "core/error.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

bool is_config_file(const fs::path& file) {
  std::error_code ec;
  return fs::exists(file, ec) && !fs::is_directory(file, ec);
}

std::string list_of(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

}  // namespace

fs::path program_folder() {
  std::error_code ec;
  return fs::read_symlink("/proc/self/exe", ec).parent_path();
}

std::vector<fs::path> config_folders() {
  std::vector<fs::path> out;
  std::error_code ec;
  const auto add = [&](const fs::path& folder) {
    if (fs::is_directory(folder, ec)) out.push_back(folder.lexically_normal());
  };
  if (const char* stated = std::getenv("SWATH_CONFIGS"); stated && *stated) add(stated);
  const fs::path program = program_folder();
  if (program.empty()) return out;
  add(program / "../share/swath/configs");
  if (fs::exists(program / "../../../tools/command.h", ec)) add(program / "../../../configs");
  return out;
}

std::vector<std::string> config_names() {
  std::vector<std::string> out;
  std::error_code ec;
  for (const fs::path& folder : config_folders())
    for (fs::directory_iterator at(folder, ec), end; !ec && at != end; at.increment(ec))
      if (at->path().extension() == ".toml") out.push_back(at->path().stem().string());
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

fs::path find_config(const fs::path& given) {
  if (is_config_file(given)) return given;
  const auto expect_no_folder = [&given] {
    std::error_code ec;
    if (fs::is_directory(given, ec))
      throw core::usage_error("is a folder, and a config is needed: a pipeline, .toml or .json", given.string(),
                              "a survey goes with it by --survey FOLDER/survey.toml; clouds go to `swath dtm`, `classify`, `qc`");
  };
  if (given.empty() || given.has_parent_path() || given.has_extension()) {
    expect_no_folder();
    throw core::usage_error("no such file", given.string(), "check the name of the config");
  }
  for (const fs::path& folder : config_folders())
    if (const fs::path file = folder / (given.string() + ".toml"); is_config_file(file)) return file;
  expect_no_folder();
  const std::vector<std::string> known = config_names();
  const std::string near = core::nearest(given.string(), known);
  throw core::usage_error("no such file, and no config of that name comes with the program", given.string(),
                          known.empty()  ? "its folder of configs was not found: name the file, or set SWATH_CONFIGS"
                          : near.empty() ? "there are " + list_of(known)
                                         : "did you mean '" + near + "'?");
}

}  // namespace swath::pipeline
