// SPDX-License-Identifier: GPL-3.0-or-later
// What check point tables call the cover of the ground, in English, German, French, Spanish, Italian and Dutch.
#pragma once

#include <string>
#include <vector>

namespace swath::quality {

/// The English word for a cover: open, bare, urban, NVA for ground without vegetation; grass, crops, brush, forest, VVA for vegetated one.
/// Case, accents, and '_' and '-' for blanks do not matter. Empty where the word is not known.
std::string cover_in_english(const std::string& cover);

/// Is the cover one of `open`, by itself or by its word in English?
bool is_open_cover(const std::string& cover, const std::vector<std::string>& open);

}  // namespace swath::quality
