// SPDX-License-Identifier: GPL-3.0-or-later
// What a result was made from: hashes of the inputs, fingerprints of the stages, versions.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/config/value.h"
#include "pipeline/plan.h"

namespace swath::pipeline {

std::string_view program_version();

struct Input {
  std::filesystem::path file;
  std::uint64_t bytes = 0;
  std::string hash;
};

/// Every file the plan reads, hashed, in the order of the stages: each once, with those that lie beside it and are read with it (index
/// and attributes of a Shapefile, georeference of a raster), the calibration file, and the grids that PROJ has between
/// the CRSs that survey.toml states, the first cloud's and WGS84; not those of CRSs that only other files state.
std::vector<Input> inputs_of(const Plan& plan);

/// One fingerprint per stage; each holds those before it, the inputs, the survey and the tiling, so that a stage's
/// result is still valid exactly where its fingerprint is the same.
std::vector<std::string> fingerprints(const Plan& plan, const std::vector<Input>& inputs);

/// The project's identifier in files that have one (a UUID, version 8 of RFC 9562): made of a fingerprint, so that equal input gives the
/// same one.
std::array<std::uint8_t, 16> project_id(const std::string& fingerprint);

/// A day, UTC.
struct Day {
  int year = 0, of_year = 0;  ///< day of year from 1
};
/// Today, or the day of SOURCE_DATE_EPOCH (seconds since 1970, reproducible-builds.org) where that is set.
Day creation_day();

/// Names and versions of the libraries in use.
core::Value versions();

}  // namespace swath::pipeline
