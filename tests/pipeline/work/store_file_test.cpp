// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/store_file.h"

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

using core::Block;
using core::Column;

class Chunks : public ::testing::Test {
 protected:
  Chunks() {
    for (int i = 0; i < 10; ++i) {
      block_.x.push_back(i), block_.y.push_back(2 * i), block_.z.push_back(3 * i);
      block_.classification.push_back(static_cast<std::uint8_t>(i));
    }
    StoreFile file(file_, StoreFile::Mode::append, &sum_);
    write_chunks(file, block_, 0, 4, all_);
    first_chunk_ = file.written();
    write_chunks(file, block_, 4, 6, all_);
    written_ = file.written();
  }
  /// Rows that come back.
  size_t read() const {
    StoreFile file(file_, StoreFile::Mode::read);
    Block to;
    size_t row = 0;
    core::ColumnSet seen;
    while (read_chunk(file, to, row, all_, seen)) {
    }
    return row;
  }
  const core::ColumnSet all_{Column::x, Column::y, Column::z, Column::classification};
  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "a.pts";
  Block block_;
  Checksum sum_;
  std::uint64_t first_chunk_ = 0, written_ = 0;
};

TEST_F(Chunks, ComeBackAndAreKnownByLengthAndChecksum) {
  EXPECT_EQ(read(), 10u);
  EXPECT_EQ(written_, std::filesystem::file_size(file_));
  EXPECT_EQ(sum_.text(), checksum_of_file(file_));
}

TEST_F(Chunks, AFileCutAnywhereBehindAWholeChunkIsAnErrorAndNothingIsMadeRoomFor) {
  const std::string bytes = test::read_bytes(file_);
  for (size_t n = 1; n < bytes.size(); ++n) {
    test::write_bytes(file_, bytes.substr(0, n));
    if (n == first_chunk_) continue;
    EXPECT_THROW(read(), core::SystemError) << n;
  }
}

TEST_F(Chunks, AHeadOfManyPointsIsAnErrorNotAllMemory) {
  std::string bytes = test::read_bytes(file_);
  bytes[3] = '\x7f';
  test::write_bytes(file_, bytes);
  EXPECT_THROW(read(), core::SystemError);
}

TEST_F(Chunks, AFileThatIsGoneIsAnError) {
  std::filesystem::remove(file_);
  EXPECT_THROW(read(), core::SystemError);
}

}  // namespace
}  // namespace swath::pipeline
