// SPDX-License-Identifier: GPL-3.0-or-later
// The work folder: a piece's record behind a right checksum, as one who forges it could make it, and chunks of points as they are read
// back.
#include "pipeline/work/checksum.h"
#include "pipeline/work/piece_record.h"
#include "pipeline/work/store_file.h"
#include "tests/fuzz/target.h"

using namespace swath;

namespace {

void read_forged_record(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path within = [] {
    std::filesystem::create_directories(fuzz::folder() / "a" / "b");
    return std::filesystem::path("a/b/piece.json");
  }();
  std::string text(reinterpret_cast<const char*>(data), size);
  const std::string sum = pipeline::checksum_of(text);
  text += "\nxxh3 " + sum + "\n";
  const auto file = fuzz::given(within, reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  if (const auto record = pipeline::read_record(file)) pipeline::is_whole(*record, file.parent_path());
}

void read_chunks(const std::filesystem::path& file) {
  core::ColumnSet wanted, seen;
  for (int c = 0; c < core::column_count; ++c) wanted.add(static_cast<core::Column>(c));
  pipeline::StoreFile store(file, pipeline::StoreFile::Mode::read);
  // Each chunk into a block of its own: in one block all rows of the column `source` take the width of the widest.
  for (bool more = true; more;) {
    core::Block block;
    std::size_t row = 0;
    more = pipeline::read_chunk(store, block, row, wanted, seen);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::reading([&] { read_forged_record(data, size); });
  const auto file = fuzz::given("points.cols", data, size);
  fuzz::reading([&] { read_chunks(file); });
  return 0;
}
