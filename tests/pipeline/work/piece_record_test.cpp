// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/piece_record.h"

#include "pipeline/work/checksum.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

class Piece : public ::testing::Test {
 protected:
  Piece() {
    test::write_bytes(folder_ / "stage/a.cols", "the columns of a");
    test::write_bytes(folder_ / "stage/products/a.laz", "the points of a");
    core::Value note = core::Value::object();
    note["seconds"] = 1.5;
    write_record(record_, {piece_files(stage_, {stage_ / "a.cols", stage_ / "products/a.laz", stage_ / "a.cols"}), note});
  }
  bool whole() const {
    const auto read = read_record(record_);
    return read && is_whole(*read, stage_);
  }
  test::TemporaryFolder folder_;
  fs::path stage_ = folder_ / "stage", record_ = stage_ / "a.done";
};

TEST_F(Piece, ComesBackWithItsFilesAndNote) {
  const auto read = read_record(record_);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->files.size(), 2u) << "each file once";
  EXPECT_EQ(read->files[1].name, fs::path("products/a.laz"));
  EXPECT_EQ(read->files[1].bytes, 15u);
  EXPECT_EQ(read->note.find("seconds")->as_number(), 1.5);
  EXPECT_TRUE(whole());
}

TEST_F(Piece, FilesWithoutChecksumAreNotReadAndTakeThePlaceOfTheirNames) {
  auto files = read_record(record_)->files;
  test::write_bytes(stage_ / "products/a.laz", "all points");
  test::write_bytes(stage_ / "products/b.gpkg", "lines");
  const auto merged = files_without_checksum(stage_, {stage_ / "products/b.gpkg", stage_ / "products/a.laz"});
  ASSERT_EQ(merged.size(), 2u);
  for (const PieceFile& f : merged) EXPECT_EQ(f.checksum, "");
  replace_files(files, merged);
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(files[0].name, fs::path("a.cols"));
  EXPECT_NE(files[0].checksum, "");
  EXPECT_EQ(files[1].name, fs::path("products/a.laz"));
  EXPECT_EQ(files[1].bytes, 10u);
  EXPECT_EQ(files[2].bytes, 5u);
}

TEST_F(Piece, IsNotFinishedWithoutAFileThatWasMade) {
  const std::vector<fs::path> made = {stage_ / "a.cols", stage_ / "gone"};
  EXPECT_THROW(piece_files(stage_, made), core::SystemError);
  EXPECT_THROW(files_without_checksum(stage_, made), core::SystemError);
}

TEST_F(Piece, AFileThatIsNotAsItWasIsSeen) {
  const fs::path file = stage_ / "a.cols";
  const std::string bytes = test::read_bytes(file);
  for (const std::string& damaged : {std::string(), bytes.substr(1), bytes + "x", "The columns of a" + std::string()}) {
    test::write_bytes(file, damaged);
    EXPECT_FALSE(whole()) << damaged;
  }
  fs::remove(file);
  EXPECT_FALSE(whole());
  test::write_bytes(stage_ / "elsewhere", bytes);
  fs::create_symlink("elsewhere", file);
  EXPECT_FALSE(whole()) << "a link is not a file of ours";
  fs::remove(file);
  fs::create_directory(file);
  EXPECT_FALSE(whole());
}

TEST_F(Piece, AFileBeyond4GigabytesComesBack) {
  constexpr std::uint64_t large = 5'000'000'000;
  write_record(record_, {{{"a.laz", large, "0123456789abcdef"}}, {}});
  const auto read = read_record(record_);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->files.at(0).bytes, large);
}

// As one could make it who hands his output folder on.
TEST_F(Piece, AForgedRecordOfAnotherFormIsNone) {
  for (const std::string files :
       {"3", "[3]", "[[]]", "[[\"a\"]]", "[[\"a\", \"b\", \"c\"]]", "[[\"a\", 1.5, \"c\"]]", "[{}]", "[{\"name\": \"a\"}]",
        "[{\"name\": \"a\", \"bytes\": 1.5, \"checksum\": \"c\"}]", "[{\"name\": \"a\", \"bytes\": 1, \"checksum\": 2}]"}) {
    const std::string text = "{\"piece\": \"" + (stage_.parent_path().filename() / "stage/a.done").generic_string() +
                             "\", \"files\": " + files + ", \"note\": {}}\n";
    test::write_bytes(record_, text + "\nxxh3 " + checksum_of(text) + "\n");
    EXPECT_FALSE(read_record(record_)) << files;
  }
  const std::string text = "{\"piece\": 3, \"files\": [], \"note\": {}}\n";
  test::write_bytes(record_, text + "\nxxh3 " + checksum_of(text) + "\n");
  EXPECT_FALSE(read_record(record_));
}

TEST_F(Piece, EveryFlippedBitOfARecordIsSeen) {
  const std::string bytes = test::read_bytes(record_);
  for (size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << (i % 8)));
    test::write_bytes(record_, damaged);
    EXPECT_FALSE(read_record(record_)) << "byte " << i;
  }
  for (size_t n = 0; n < bytes.size(); ++n) {
    test::write_bytes(record_, bytes.substr(0, n));
    EXPECT_FALSE(read_record(record_)) << n << " bytes";
  }
  fs::remove(record_);
  EXPECT_FALSE(read_record(record_));
}

TEST_F(Piece, AnothersRecordIsNotTakenForIt) {
  test::write_bytes(folder_ / "other/a.cols", "the columns of a");
  test::write_bytes(folder_ / "other/products/a.laz", "the points of a");
  fs::copy_file(record_, folder_ / "other/a.done");
  EXPECT_FALSE(read_record(folder_ / "other/a.done"));
  fs::copy_file(record_, stage_ / "b.done");
  EXPECT_FALSE(read_record(stage_ / "b.done"));
}

}  // namespace
}  // namespace swath::pipeline
