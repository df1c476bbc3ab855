// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/released_points.h"

#include <algorithm>

#include "pipeline/work/piece_record.h"
#include "pipeline/work/work_folder.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Value;

/// Are all pieces there that note_release() named?
bool are_there(const fs::path& strips) {
  const std::optional<PieceRecord> record = read_record(strips / released_name);
  const Value* needed = record ? record->note.find("needed") : nullptr;
  return needed && needed->is_array() && std::all_of(needed->items().begin(), needed->items().end(), [&](const Value& piece) {
           return piece.is_text() && fs::exists(strips.parent_path() / piece.as_text());
         });
}

}  // namespace

void note_release(const fs::path& strips, const std::vector<fs::path>& made) {
  Value::Array needed;
  for (const fs::path& stage : made) {
    if (!fs::exists(stage)) continue;
    for (const auto& entry : fs::directory_iterator(stage))
      if (entry.path().extension() == ".done") needed.emplace_back((stage.filename() / entry.path().filename()).generic_string());
  }
  write_record(strips / released_name, {{}, Value(Value::Object{{"needed", std::move(needed)}})});
}

std::uint64_t give_up_strips(const fs::path& strips, const std::function<bool(TileKey)>& is_written) {
  if (!fs::exists(strips)) return 0;
  const bool needs_none = are_there(strips);
  std::vector<fs::path> given_up;
  for (const auto& entry : fs::directory_iterator(strips)) {
    if (!entry.is_directory() || !TileStore::is_committed(entry.path())) continue;
    const std::vector<TileKey> gone = TileStore::released(entry.path());
    if (gone.empty() || (needs_none && std::all_of(gone.begin(), gone.end(), is_written))) continue;
    given_up.push_back(entry.path());
  }
  for (const fs::path& strip : given_up) fs::remove_all(strip);
  return given_up.size();
}

}  // namespace swath::pipeline
