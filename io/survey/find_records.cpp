// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/find_records.h"

#include <algorithm>
#include <exception>
#include <system_error>

#include "core/error.h"
#include "io/store/address.h"
#include "io/survey/info.h"
#include "io/text/output_file.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;

/// The files of folder / `inner` and of the folders in it, by their names relative to `folder`. A folder that cannot be read and what is no
/// file at all (a pipe, a link to nothing) are entries with a fault; `folder` itself must be readable.
void add_files(const fs::path& folder, const fs::path& inner, std::vector<FoundFile>& out) {
  std::error_code ec;
  fs::directory_iterator at(folder / inner, ec);
  if (ec && inner.empty()) throw_system_error("cannot read the folder", folder, ec.value());
  if (ec) return out.push_back({inner, {}, "the folder is not readable: " + ec.message()}), void();
  for (const fs::directory_iterator end; at != end; at.increment(ec)) {
    if (ec) throw_system_error("cannot read the folder", folder / inner, ec.value());
    const fs::path name = inner / at->path().filename();
    std::error_code absent;
    const fs::file_status status = at->status(absent);
    if (at->path().filename().string().starts_with(".") || name == "survey.toml") continue;
    if (is_address(name / "x")) continue;  // a folder "https:": its files would be taken for addresses
    if (fs::is_directory(status)) {
      if (!at->is_symlink(absent) && !fs::exists(at->path() / "report.json", absent)) add_files(folder, name, out);
    } else if (fs::is_regular_file(status)) {
      out.push_back({name});
    } else {
      out.push_back({name, {}, fs::exists(status) ? "it is not a file" : "the link leads to nothing"});
    }
  }
}

}  // namespace

std::vector<FoundFile> find_records(const fs::path& folder, const std::function<void(std::size_t, std::size_t, const fs::path&)>& on_file) {
  std::error_code ec;
  if (!fs::is_directory(folder, ec)) throw core::usage_error("no such folder", folder.string(), "name the folder of a survey's files");
  std::vector<FoundFile> out;
  add_files(folder, {}, out);
  std::sort(out.begin(), out.end(), [](const FoundFile& a, const FoundFile& b) { return a.name < b.name; });
  for (std::size_t k = 0; k < out.size(); ++k) {
    FoundFile& f = out[k];
    if (on_file) on_file(k, out.size(), f.name);
    if (!f.fault.empty()) continue;
    try {
      f.facts = describe_file(folder / f.name);
    } catch (const std::exception& e) {  // a file that is not what its name says may fail in any way
      f.fault = e.what();
    }
  }
  return out;
}

}  // namespace swath::io
