// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/input_guard.h"

#include <sys/stat.h>

#include <algorithm>
#include <climits>
#include <set>
#include <string>

#include "core/error.h"
#include "io/vector/side_files.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

// What a run puts before and behind a product's name: the work folder's own folders, a temporary name, the label of a tile.
constexpr size_t room_in_path = 300, room_in_name = 30;

/// Every text of a table that is the name of a file, relative to `folder`.
void add_named(const core::Value& v, const fs::path& folder, std::set<fs::path>& out) {
  if (v.is_text()) {
    std::error_code ec;
    const fs::path file = folder / v.as_text();
    if (!v.as_text().empty() && v.as_text().size() < PATH_MAX && fs::is_regular_file(file, ec)) out.insert(file);
  } else if (v.is_array()) {
    for (const core::Value& one : v.items()) add_named(one, folder, out);
  } else if (v.is_object()) {
    for (const auto& [key, one] : v.members()) add_named(one, folder, out);
  }
}

bool holds(const fs::path& folder, const fs::path& file) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

bool names_a_file(const fs::path& product) {
  constexpr const char* endings[] = {".json", ".csv", ".html", ".gpkg", ".dxf", ".geojson", ".vrt", ".tif", ".png", ".svg",
                                     ".pdf",  ".xml", ".sbet", ".toml", ".txt", ".smrmsg",  ".pos", ".laz", ".las"};
  return std::find(std::begin(endings), std::end(endings), product.extension().string()) != std::end(endings);
}

void check_lengths(const fs::path& product, const fs::path& output) {
  const auto refuse = [&](const std::string& what) {
    throw core::usage_error(what, product.string().substr(0, 200) + (product.string().size() > 200 ? "..." : ""),
                            "choose an --output with a shorter path, or a shorter name of the product");
  };
  if ((output / product).string().size() + room_in_path > PATH_MAX) refuse("the path of a product is longer than this system takes");
  for (const fs::path& part : product)
    if (part.string().size() + room_in_name > NAME_MAX) refuse("the name of a product is longer than this system takes");
}

}  // namespace

std::vector<fs::path> files_of(const Plan& plan) {
  std::set<fs::path> out;
  io::Survey survey = plan.survey;
  add_named(core::effective_values(core::described(survey)), plan.survey.folder, out);
  for (const fs::path& file : input_files(plan)) out.insert(file);
  for (const fs::path& file : std::set<fs::path>(out))
    for (const fs::path& beside : io::side_files(file)) out.insert(beside);
  out.insert(plan.config);
  out.insert(plan.survey_file);
  std::error_code ec;
  std::erase_if(out, [&](const fs::path& file) { return !fs::exists(file, ec); });
  return {out.begin(), out.end()};
}

InputGuard::InputGuard(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    std::error_code ec;
    if (fs::path canonical = fs::canonical(file, ec); !ec) files_.try_emplace(std::move(canonical), file);
    struct stat info {};
    if (::stat(file.c_str(), &info) == 0) ids_.try_emplace({info.st_dev, info.st_ino}, file);
  }
}

void InputGuard::expect_other(const fs::path& there, const fs::path& product) const {
  struct stat info {};
  if (::stat(there.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return;
  const auto at = ids_.find({info.st_dev, info.st_ino});
  if (at == ids_.end()) return;
  throw core::usage_error("the run would overwrite a file that it reads, as its product " + product.string(), at->second.string(),
                          "choose another --output, or another name of the product");
}

void InputGuard::expect_apart(const fs::path& product) const {
  std::error_code ec;
  const fs::path place = fs::weakly_canonical(product, ec);
  if (!ec)
    if (const auto first = files_.lower_bound(place); first != files_.end() && holds(place, first->first))
      throw core::usage_error(place == first->first ? "the run would overwrite a file that it reads, as its product " + product.string()
                                                    : "the run reads a file in the folder of its own product " + product.string(),
                              first->second.string(), "choose another --output, or another name of the product");
  expect_other(product, product);
  if (!fs::is_directory(product, ec)) return;
  for (auto at = fs::recursive_directory_iterator(product, fs::directory_options::skip_permission_denied, ec);
       !ec && at != fs::recursive_directory_iterator(); at.increment(ec))
    expect_other(at->path(), product);
}

std::vector<fs::path> input_files(const Plan& plan) {
  std::vector<fs::path> out;
  for (const PlannedStage& s : plan.stages)
    for (const fs::path& file : s.stage->inputs(plan.survey)) out.push_back(file);
  return out;
}

std::function<void(const fs::path&)> outside_inputs(const Plan& plan) {
  return [guard = InputGuard(files_of(plan))](const fs::path& file) {
    try {
      guard.expect_apart(file);
    } catch (const core::Error& e) {
      throw core::SystemError(e.what(), e.where(), e.hint());
    }
  };
}

void check_output(const Plan& plan) {
  const fs::path output = fs::absolute(plan.run.output).lexically_normal();
  std::error_code no_file;
  if (const fs::file_status there = fs::status(output, no_file); fs::exists(there) && !fs::is_directory(there))
    throw core::usage_error("the output is a file; products go to a folder", output.string(), "name a folder by --output");
  std::vector<fs::path> products{"report.json", ".swath", ".swath-discarded"};
  for (const PlannedStage& s : plan.stages)
    for (const std::string& name : s.stage->products()) products.emplace_back(name);
  for (const fs::path& p : products) check_lengths(p, output);
  const InputGuard guard(files_of(plan));
  for (const fs::path& p : products) {
    guard.expect_apart(output / p);
    std::error_code ec;
    const fs::file_status there = fs::status(output / p, ec);
    if (fs::is_directory(there) && names_a_file(p))
      throw core::usage_error("a folder has the name of a product that is a file", (output / p).string(),
                              "move the folder away, or choose another --output");
    if (fs::exists(there) && !fs::is_directory(there) && !p.has_extension() && p != ".swath" && p != ".swath-discarded")
      throw core::usage_error("a file has the name of a product that is a folder", (output / p).string(),
                              "move the file away, or choose another --output");
  }
}

}  // namespace swath::pipeline
