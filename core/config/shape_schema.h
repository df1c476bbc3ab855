// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/config/option.h"

namespace swath::core {

/// JSON Schema of one value of that kind: its type, or the names of a choice. A quantity is a number, in SI.
Value shape_schema(const Shape& shape);

}  // namespace swath::core
