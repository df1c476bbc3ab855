// SPDX-License-Identifier: GPL-3.0-or-later
// Facts of files that this program writes and no command reads.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/config/value.h"

namespace swath::io {

/// plan.json of `swath plan`.
core::Value describe_planned_flight(const core::Value& tree);

/// Does a text begin as quality.xml does (ISO 19157-2)?
bool looks_like_quality_xml(std::string_view start);
core::Value describe_quality_xml(const std::filesystem::path& file);

}  // namespace swath::io
