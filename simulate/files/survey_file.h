// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "io/survey/survey.h"

namespace swath::simulate {

/// survey.toml of a survey: the options that differ from their defaults, and those that a reader must not have to guess.
std::string survey_toml(const io::Survey& survey, const std::string& comment);

}  // namespace swath::simulate
