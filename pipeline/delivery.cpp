// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/delivery.h"

#include <algorithm>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* list_name = "tiles.json";

std::vector<std::string> listed(const fs::path& list) {
  std::vector<std::string> out;
  if (!fs::exists(list)) return out;
  const core::Value names = io::read_value_file(list);
  if (names.is_array())
    for (const core::Value& name : names.items())
      if (name.is_text()) out.push_back(name.as_text());
  return out;
}

void copy_whole(const fs::path& from, const fs::path& to, const fs::path& named) {
  std::error_code ec;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, ec);
  if (ec) {
    const int code = ec.value();
    fs::remove(to, ec);
    io::throw_system_error("cannot write", named, code);
  }
  io::flush_to_disk(to);
}

/// `spare`: a name beside the files made, which the file has until it gets its own. Only one run works in an output folder.
void deliver_file(const fs::path& from, const fs::path& to, const fs::path& spare, bool keep) {
  const fs::path beside = to.parent_path() / (io::temporary_mark + to.filename().string());
  std::error_code ec;
  fs::create_directories(to.parent_path(), ec);
  if (ec) io::throw_system_error("cannot make the folder of the output", to, ec.value());
  fs::remove(beside, ec);  // of a run that was killed
  fs::remove(spare, ec);
  if (fs::equivalent(from, to, ec)) return;
  if (!keep) fs::create_hard_link(from, spare, ec);
  if (keep || ec)
    copy_whole(from, spare, to);
  else
    io::flush_to_disk(spare);
  fs::rename(spare, to, ec);
  if (ec == std::errc::cross_device_link) {  // a folder of the output is a link to another disk
    copy_whole(spare, beside, to);
    fs::rename(beside, to, ec);
    std::error_code ignored;
    if (ec) fs::remove(beside, ignored);
  }
  std::error_code ignored;
  fs::remove(spare, ignored);
  if (ec) io::throw_system_error("cannot finish", to, ec.value());
}

std::vector<fs::path> files_below(const fs::path& made) {
  std::vector<fs::path> files;
  if (!fs::exists(made)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(made))
    if (entry.is_regular_file() && !io::is_temporary(entry.path())) files.push_back(fs::relative(entry.path(), made));
  std::sort(files.begin(), files.end());
  return files;
}

/// Tiles of an earlier run that the new list does not have.
std::vector<fs::path> outdated(const fs::path& now, const fs::path& before) {
  const std::vector<std::string> names = listed(now);
  std::vector<fs::path> out;
  for (const std::string& old : listed(before))
    if (std::find(names.begin(), names.end(), old) == names.end()) out.push_back(before.parent_path() / fs::path(old).filename());
  return out;
}

void check_delivery(const fs::path& made, const fs::path& output, const Allowed& allowed) {
  for (const fs::path& file : files_below(made)) {
    std::error_code ec;
    if (fs::is_directory(output / file, ec))
      throw core::SystemError("a folder has the name of this product", (output / file).string(),
                              "move the folder away, then run the same command again; what is finished is kept");
    if (!allowed) continue;
    allowed(output / file);
    if (file.filename() == list_name)
      for (const fs::path& old : outdated(made / file, output / file)) allowed(old);
  }
}

void deliver_one(const fs::path& made, const fs::path& output, bool keep) {
  const std::vector<fs::path> files = files_below(made);
  const fs::path spare = made.parent_path() / (std::string(io::temporary_mark) + "delivery");
  std::set<fs::path> folders;
  for (const fs::path& file : files) {
    if (file.filename() != list_name) deliver_file(made / file, output / file, spare, keep);
    folders.insert((output / file).parent_path());
  }
  for (const fs::path& file : files) {
    if (file.filename() != list_name) continue;
    for (const fs::path& old : outdated(made / file, output / file)) {
      std::error_code ignored;
      fs::remove(old, ignored);
    }
    deliver_file(made / file, output / file, spare, keep);
  }
  for (const fs::path& folder : folders) io::flush_to_disk(folder);
}

}  // namespace

void deliver(const std::vector<fs::path>& made, const fs::path& output, bool keep, const Allowed& allowed) {
  for (const fs::path& one : made) check_delivery(one, output, allowed);
  for (const fs::path& one : made) deliver_one(one, output, keep);
}

void expect_delivered(const fs::path& file, std::uint64_t bytes) {
  std::error_code ec;
  if (fs::file_size(file, ec) == bytes && !ec) return;
  throw core::SystemError("the product was removed or changed while the run was at work", file.string(), "run the same command again");
}

void discard(const fs::path& folder, const fs::path& as) {
  std::error_code ignored;
  fs::remove_all(as, ignored);
  fs::rename(folder, as, ignored);
  fs::remove_all(as, ignored);
}

}  // namespace swath::pipeline
