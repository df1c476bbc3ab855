// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/provenance.h"

#include <xxhash.h>

#include <tbb/version.h>
#include <Eigen/Core>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>

#include "io/output_file.h"
#include "io/value_file.h"
#include "io/versions.h"

namespace swath::pipeline {

std::string_view program_version() { return SWATH_VERSION; }

std::string hash_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) io::throw_system_error("cannot open", file, errno);
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
  XXH3_64bits_reset(state.get());
  std::vector<char> buffer(1 << 20);
  while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || in.gcount() > 0)
    XXH3_64bits_update(state.get(), buffer.data(), static_cast<size_t>(in.gcount()));
  return core::hex(XXH3_64bits_digest(state.get()));
}

std::vector<Input> inputs_of(const Plan& plan) {
  std::vector<Input> out;
  for (const PlannedStage& s : plan.stages)
    for (const std::filesystem::path& file : s.stage->inputs(plan.survey)) {
      std::error_code ec;
      const auto bytes = std::filesystem::file_size(file, ec);
      if (ec) io::throw_system_error("cannot open", file, ec.value());
      out.push_back({file, bytes, hash_file(file)});
    }
  return out;
}

std::vector<std::string> fingerprints(const Plan& plan, const std::vector<Input>& inputs) {
  io::Survey survey = plan.survey;
  survey.name.clear();
  std::string text = std::string(program_version()) + "\n" + core::fingerprint_of(core::described(survey)) + "\n" +
                     core::format_number(plan.run.tile.value) + "\n";
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
