// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/earlier_survey.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "core/error.h"

namespace swath::simulate {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 22> records{
    "survey.toml",       "laser.csv",       "laser.npy",   "laser.las",        "laser.laz",     "sbet.out",
    "smrmsg.out",        "trajectory.csv",  "imu.csv",     "gnss.csv",         "events_pc.csv", "events_marks.csv",
    "loopstats",         "pps.log",         "control.csv", "check.csv",        "images.csv",    "image_points.csv",
    "block_control.csv", "block_check.csv", "block.toml",  "camera_points.csv"};
constexpr size_t files_named = 5;
constexpr std::array<std::string_view, 4> of_formats{".csv", ".npy", ".las", ".laz"};

/// A name that simulations write: one of the records, survey_FORMAT.toml.
bool is_own(const std::string& name) {
  if (std::find(records.begin(), records.end(), name) != records.end()) return true;
  return std::any_of(of_formats.begin(), of_formats.end(),
                     [&](std::string_view format) { return name == "survey_" + std::string(format.substr(1)) + ".toml"; });
}

/// A survey whose truth was taken out of it.
bool is_simulated(const fs::path& survey) {
  std::string first;
  std::ifstream in(survey);
  return std::getline(in, first) && first.starts_with(simulated_mark);
}

/// A simulation that was killed has its folder truth/, too, and is made again by the same command.
void refuse_other_records(const fs::path& folder) {
  std::error_code ec;
  if (fs::is_directory(folder / "truth", ec) || is_simulated(folder / "survey.toml")) return;
  std::vector<std::string> found;
  for (fs::directory_iterator at(folder, ec), end; !ec && at != end; at.increment(ec))
    if (const std::string name = at->path().filename().string(); is_own(name)) found.push_back(name);
  if (found.empty()) return;
  std::sort(found.begin(), found.end());
  std::string names;
  for (size_t k = 0; k < std::min(found.size(), files_named); ++k) names += (k > 0 ? ", " : "") + found[k];
  if (found.size() > files_named) names += " and " + std::to_string(found.size() - files_named) + " more";
  throw core::usage_error("the folder holds " + names + ", which no simulation wrote: records there could be overwritten", folder.string(),
                          "name a folder that does not exist yet, or move these files");
}

}  // namespace

EarlierSurvey::EarlierSurvey(const fs::path& folder) : folder_(folder) {
  std::error_code ec;
  refuse_other_records(folder);
  if (!fs::is_regular_file(folder / "truth" / "simulation.json", ec)) return;
  for (const fs::path& inside : {fs::path(), fs::path("truth")})
    for (fs::directory_iterator at(folder / inside, ec), end; !ec && at != end; at.increment(ec)) {
      const std::string name = at->path().filename().string();
      if (!at->is_regular_file(ec) || (inside.empty() && !is_own(name))) continue;
      if (const auto written = fs::last_write_time(at->path(), ec); !ec) files_[(inside / name).string()] = written;
    }
}

std::vector<std::string> EarlierSurvey::remove_stale(const std::vector<fs::path>& inputs) const {
  std::vector<std::string> out;
  for (const auto& [name, written] : files_) {
    std::error_code ec;
    if (fs::last_write_time(folder_ / name, ec) != written || ec) continue;
    const fs::path file = folder_ / name;
    if (std::any_of(inputs.begin(), inputs.end(), [&](const fs::path& input) { return fs::equivalent(input, file, ec); })) continue;
    if (fs::remove(folder_ / name, ec)) out.push_back(name);
  }
  return out;
}

}  // namespace swath::simulate
