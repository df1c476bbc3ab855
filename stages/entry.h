// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string_view>

#include "stages/stage.h"

namespace swath::stages {

/// A line of the registry.
struct Entry {
  std::string_view name;
  std::function<std::unique_ptr<Stage>()> make;
};

}  // namespace swath::stages
