// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/tile_columns.h"

namespace swath::filters {

/// Of the ground filters: usable last returns in, class ground or unassigned out.
constexpr core::TileColumns ground_columns{.needs = {core::Column::flags},
                                           .reads = {core::Column::return_number, core::Column::return_count},
                                           .gives = {core::Column::classification}};

}  // namespace swath::filters
