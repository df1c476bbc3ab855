// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/record_count.h"

#include <string>
#include <string_view>
#include <vector>

#include "io/las/las_header.h"
#include "io/records/csd.h"
#include "io/store/input_file.h"
#include "io/text/npy.h"

namespace swath::io {

std::optional<std::uint64_t> stated_records(const std::filesystem::path& file) {
  std::string start(6, ' ');
  start.resize(InputFile(file).read_some(0, start.data(), start.size()));
  if (start.starts_with("LASF")) {
    std::vector<std::string> ignored;
    return read_las_header(file, ignored).point_count;
  }
  if (start.starts_with("\x93NUMPY")) return read_npy_header(file).rows;
  if (start.starts_with(std::string_view("CSD\0", 4))) return CsdReader(file).pulses();
  return std::nullopt;
}

}  // namespace swath::io
