// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/cloud/tile_list.h"

#include "io/text/output_file.h"
#include "io/text/value_file.h"

namespace swath::stages {

void write_list(const std::filesystem::path& folder, const std::vector<std::string>& files) {
  core::Value list = core::Value::array();
  for (const std::string& f : files) list.push(f);
  io::write_text_file(folder / "tiles.json", io::to_json(list));
}

}  // namespace swath::stages
