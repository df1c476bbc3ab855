// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/tile_list.h"

#include <algorithm>

#include "io/output_file.h"
#include "io/value_file.h"

namespace swath::stages {

void keep_list(const std::filesystem::path& folder, const std::vector<std::string>& files) {
  const std::filesystem::path list = folder / "tiles.json";
  if (std::filesystem::exists(list)) {
    const core::Value before = io::read_value_file(list);
    if (before.is_array())
      for (const core::Value& file : before.items())
        if (file.is_text() && std::find(files.begin(), files.end(), file.as_text()) == files.end()) {
          std::error_code ignored;
          std::filesystem::remove(folder / std::filesystem::path(file.as_text()).filename(), ignored);
        }
  }
  core::Value now = core::Value::array();
  for (const std::string& f : files) now.push(f);
  io::write_text_file(list, io::to_json(now));
}

}  // namespace swath::stages
