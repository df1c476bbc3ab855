// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/checksum.h"

#include "core/error.h"
#include "io/store/object.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

TEST(Checksum, IsOfTheContentAlone) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a", "one");
  test::write_bytes(folder / "b", "one");
  test::write_bytes(folder / "c", "two");
  test::write_bytes(folder / "empty", "");
  EXPECT_EQ(checksum_of_file(folder / "a"), checksum_of_file(folder / "b"));
  EXPECT_NE(checksum_of_file(folder / "a"), checksum_of_file(folder / "c"));
  EXPECT_EQ(checksum_of_file(folder / "a"), checksum_of("one"));
  EXPECT_EQ(checksum_of_file(folder / "empty"), "2d06800538d394c2");  // XXH3 of nothing, as its specification prints it
}

TEST(Checksum, PieceByPieceIsTheSame) {
  const std::string bytes(100000, 'x');
  Checksum sum;
  for (size_t at = 0; at < bytes.size(); at += 777) sum.add(bytes.data() + at, std::min<size_t>(777, bytes.size() - at));
  EXPECT_EQ(sum.text(), checksum_of(bytes));
}

TEST(Checksum, OfAnInputIsThatOfItsContentAlsoInAStoreWithoutVersions) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a", std::string(3'000'000, 'a'));
  const std::filesystem::path object = "/vsimem/checksum_test/a";
  io::store_file(folder / "a", object, "");
  EXPECT_EQ(checksum_of_input(folder / "a"), checksum_of_file(folder / "a"));
  EXPECT_EQ(checksum_of_input(object), checksum_of_file(folder / "a"));
  test::write_bytes(folder / "a", "b");
  io::store_file(folder / "a", object, "");
  EXPECT_EQ(checksum_of_input(object), checksum_of_file(folder / "a"));
  EXPECT_THROW(checksum_of_input("/vsimem/checksum_test/none"), core::Error);
}

TEST(Checksum, AFileThatIsNotThereOrIsAFolderIsAnError) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(checksum_of_file(folder / "none"), core::SystemError);
  EXPECT_THROW(checksum_of_file(folder.path()), core::SystemError);
}

}  // namespace
}  // namespace swath::pipeline
