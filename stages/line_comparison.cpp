// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/line_comparison.h"

#include <cmath>

#include "io/text/value_file.h"

namespace swath::stages {
namespace {

double number(const core::Value& v, std::string_view key) {
  const core::Value* found = v.find(key);
  return found && found->is_number() ? found->as_number() : std::nan("");
}

}  // namespace

std::optional<quality::KnownLines> known_lines(const Context& context) {
  const std::filesystem::path file = context.made("lines.json");
  if (file.empty()) return std::nullopt;
  const core::Value v = io::read_value_file(file);
  quality::KnownLines out{{}, number(v, "scatter_m"), number(v, "common_m"), number(v, "residual_m"), number(v, "common_horizontal_m")};
  if (const double steep = number(v, "steep_places"); std::isfinite(steep)) out.steep_places = static_cast<int>(steep);
  for (const core::Value& l : v.find("lines")->items())
    out.offsets[static_cast<int>(l.find("line")->as_int())] = l.find("offset_m")->as_number();
  return out;
}

}  // namespace swath::stages
