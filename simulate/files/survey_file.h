// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/config/value.h"
#include "io/survey/survey.h"

namespace swath::simulate {

/// A tree as TOML: scalars first, then tables and lists of tables. Throws Error for lists of mixed kinds.
std::string toml_of(const core::Value& tree);

/// survey.toml of a survey: the options that differ from their defaults, and those that a reader must not have to guess.
std::string survey_toml(const io::Survey& survey, const std::string& comment);

}  // namespace swath::simulate
