// SPDX-License-Identifier: GPL-3.0-or-later
// Names and defaults of the options of PDAL's filters, and what they are here.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/config/value.h"

namespace swath::pipeline {

/// What a number of PDAL's counts.
enum class PdalUnit { none, across, height };

struct PdalOption {
  const char *name, *ours;
  PdalUnit unit = PdalUnit::none;
  std::optional<double> set{};  ///< PDAL's default where ours differs
};

/// A filter that is one stage here, with the options that both have and what is fixed here.
struct PdalFilter {
  const char *type, *ours;
  std::vector<PdalOption> options;
  std::vector<std::pair<const char*, core::Value>> fixed;
  const char* differs;
  const char* method = "";  ///< the filter's option `method` that this is; empty: any, or the filter has none
};

const std::vector<PdalFilter>& pdal_filters();

/// What comes nearest here to a stage of PDAL's that has no counterpart; empty where nothing does.
std::string pdal_nearest(const std::string& type);

/// May the option be written because its value is what is the case here: "returns" = "last, only"?
bool is_the_case(const std::string& type, const std::string& name, const core::Value& value);

/// The classes that the limits of a filters.range keep, "Classification[2:2],Classification[9:9]": ranges of one dimension are
/// alternatives. Empty where they are none of whole numbers from 0 to 255; `why` then says what they are instead.
std::vector<int> classes_of_limits(const std::string& limits, std::string& why);

}  // namespace swath::pipeline
