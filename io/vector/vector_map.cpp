// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/vector_map.h"

#include <gdal_priv.h>

#include "io/vector/gdal_door.h"
#include "io/vector/height_statement.h"

namespace swath::io {

VectorMap read_map(const std::filesystem::path& file, const std::string& field) {
  const GdalMessages messages;
  const Dataset set = required_vector(file, messages);
  VectorMap out{height_unit_in(*set, file), lines_in(*set, field), spots_in(*set, field)};
  messages.check("cannot read the vector file", file);
  return out;
}

}  // namespace swath::io
