// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/tile_list.h"

#include "io/output_file.h"
#include "io/value_file.h"

namespace swath::stages {

void write_list(const std::filesystem::path& folder, const std::vector<std::string>& files) {
  core::Value list = core::Value::array();
  for (const std::string& f : files) list.push(f);
  io::write_text_file(folder / "tiles.json", io::to_json(list));
}

}  // namespace swath::stages
