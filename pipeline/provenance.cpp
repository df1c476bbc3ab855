// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/provenance.h"

#include <tbb/version.h>
#include <Eigen/Core>
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <set>

#include "core/geo/proj_grids.h"
#include "io/store/address.h"
#include "io/store/input_file.h"
#include "io/survey/versions.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "io/vector/side_files.h"
#include "pipeline/work/checksum.h"

namespace swath::pipeline {

std::string_view program_version() { return SWATH_VERSION; }

namespace {

/// Counted up whenever what lies in the work folder is written otherwise: work of another format is not gone on from.
constexpr int work_format = 8;

/// Every value of a key `crs` in the survey's tree.
void add_crs(const core::Value& v, std::vector<std::string>& out) {
  if (v.is_array())
    for (const core::Value& one : v.items()) add_crs(one, out);
  if (!v.is_object()) return;
  for (const auto& [key, one] : v.members()) {
    if (key == "crs" && one.is_text() && !one.as_text().empty()) out.push_back(one.as_text());
    add_crs(one, out);
  }
}

/// The grids of PROJ that the survey's coordinates may go through: between the CRSs that survey.toml states, the first cloud's, and WGS84.
/// CRSs that only files state (a control table, breaklines, other clouds) are not looked at: a grid that only these need is not found.
std::vector<std::filesystem::path> grids_of(const Plan& plan) {
  io::Survey survey = plan.survey;
  std::vector<std::string> definitions;
  add_crs(core::effective_values(core::described(survey)), definitions);
  for (const PlannedStage& s : plan.stages)
    if (s.stage->is_source())
      if (const std::string own = s.stage->own_crs(plan.survey); !own.empty()) definitions.push_back(own);
  std::vector<core::Crs> all{core::wgs84_geodetic()};
  std::sort(definitions.begin(), definitions.end());
  definitions.erase(std::unique(definitions.begin(), definitions.end()), definitions.end());
  for (const std::string& definition : definitions) all.emplace_back(definition);
  std::set<std::filesystem::path> out;
  for (size_t i = 0; i < all.size(); ++i)
    for (size_t k = 0; k < i; ++k)
      for (const std::filesystem::path& file : core::grid_files_between(all[k], all[i])) out.insert(file);
  return {out.begin(), out.end()};
}

Input input_of(const std::filesystem::path& file) {
  if (io::is_address(file)) return {file, io::InputFile(file).size(), checksum_of_input(file)};
  std::error_code ec;
  const auto bytes = std::filesystem::file_size(file, ec);
  if (ec) io::throw_system_error("cannot open", file, ec.value());
  return {file, bytes, checksum_of_input(file)};
}

}  // namespace

std::vector<Input> inputs_of(const Plan& plan) {
  std::vector<Input> out;
  std::set<std::filesystem::path> known;
  const auto add = [&](const std::filesystem::path& file) {
    if (!known.insert(file).second) return false;
    out.push_back(input_of(file));
    return true;
  };
  for (const PlannedStage& s : plan.stages)
    for (const std::filesystem::path& file : s.stage->inputs(plan.survey))
      if (add(file))
        for (const std::filesystem::path& beside : io::side_files(file)) add(beside);
  if (plan.survey.calibration_file) add(io::resolve(plan.survey, *plan.survey.calibration_file));
  for (const std::filesystem::path& grid : grids_of(plan)) add(grid);
  return out;
}

std::vector<std::string> fingerprints(const Plan& plan, const std::vector<Input>& inputs) {
  io::Survey survey = plan.survey;
  survey.name.clear();
  std::string text = std::string(program_version()) + "\nwork " + std::to_string(work_format) + "\n" +
                     core::fingerprint_of(core::described(survey)) + "\n" + core::format_number(plan.run.tile.value) + "\n";
  for (const Input& i : inputs) text += i.hash + "\n";
  std::uint64_t chain = core::fnv1a(text);
  std::vector<std::string> out;
  for (const PlannedStage& s : plan.stages) {
    chain = core::fnv1a(std::string(s.stage->info().name) + core::fingerprint_of(s.describe()), chain);
    out.push_back(core::hex(chain));
  }
  return out;
}

std::array<std::uint8_t, 16> project_id(const std::string& fingerprint) {
  std::array<std::uint8_t, 16> id{};
  const std::uint64_t a = core::fnv1a("project " + fingerprint), b = core::fnv1a(fingerprint + " project");
  std::memcpy(id.data(), &a, 8);
  std::memcpy(id.data() + 8, &b, 8);
  // Version and variant, as LAS stores them: the first three fields little-endian (R15, table 3).
  id[7] = static_cast<std::uint8_t>((id[7] & 0x0f) | 0x80);
  id[8] = static_cast<std::uint8_t>((id[8] & 0x3f) | 0x80);
  return id;
}

Day creation_day() {
  std::time_t now = std::time(nullptr);
  if (const char* stated = std::getenv("SOURCE_DATE_EPOCH")) {
    char* end = nullptr;
    const long long seconds = std::strtoll(stated, &end, 10);
    if (end != stated && *end == '\0') now = static_cast<std::time_t>(seconds);
  }
  std::tm utc{};
  gmtime_r(&now, &utc);
  return {utc.tm_year + 1900, utc.tm_yday + 1};
}

core::Value versions() {
  core::Value out = io::library_versions();
  out["Eigen"] =
      std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." + std::to_string(EIGEN_MINOR_VERSION);
  out["oneTBB"] = TBB_VERSION_STRING;
  return out;
}

}  // namespace swath::pipeline
