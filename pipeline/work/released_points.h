// SPDX-License-Identifier: GPL-3.0-or-later
// Points of tiles that no stage reads any more are removed while the run goes on: their room is that of the products made of them. A run
// that was killed goes on without them as long as all that was made of them is whole; otherwise their strips are read again.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "pipeline/tile_store.h"

namespace swath::pipeline {

/// Before the first release: names the records of the pieces without which the points would be needed again. `strips`: the strips' folder;
/// `made`: the folders of the stages whose pieces are finished.
void note_release(const std::filesystem::path& strips, const std::vector<std::filesystem::path>& made);

/// Gives up the strips that lack points which are needed: of a tile that is not written, or because a piece is not there. Returns their
/// number.
std::uint64_t give_up_strips(const std::filesystem::path& strips, const std::function<bool(TileKey)>& is_written);

}  // namespace swath::pipeline
