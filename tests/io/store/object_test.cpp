// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/store/object.h"

#include <cpl_conv.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "io/store/address.h"
#include "tests/io/store/memory_object.h"

namespace swath::io {
namespace {

TEST(StoredObject, GivesAnyRangeAndNoMoreThanThereIs) {
  std::string bytes(100000, '\0');
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7 + i / 251);
  const test::MemoryObject there("object_test/a.bin", bytes);
  StoredObject object(there.address());
  EXPECT_EQ(object.size(), bytes.size());
  for (const std::uint64_t at : {0ull, 1ull, 50000ull, 99999ull, 0ull}) {
    std::string got(60000, '\1');
    const size_t n = object.read_some(at, got.data(), got.size());
    ASSERT_EQ(n, std::min<size_t>(got.size(), bytes.size() - at));
    EXPECT_TRUE(got.compare(0, n, bytes, at, n) == 0) << at;
  }
  char one = 0;
  EXPECT_EQ(object.read_some(bytes.size(), &one, 1), 0u);
  EXPECT_EQ(object.read_some(~std::uint64_t{0}, &one, 1), 0u);
}

TEST(StoredObject, OneThatIsNotThereIsAnErrorWithItsAddress) {
  try {
    StoredObject object("/vsimem/object_test/none.laz");
    FAIL() << "opened";
  } catch (const core::Error& e) {
    EXPECT_EQ(e.where(), "/vsimem/object_test/none.laz");
    EXPECT_EQ(e.code(), core::Exit::bad_data);
    EXPECT_FALSE(e.hint().empty());
  }
  EXPECT_THROW(object_state("/vsimem/object_test/none.laz"), core::Error);
}

TEST(StoredObject, OneThatShrinksWhileItIsReadIsAnError) {
  std::string bytes(1000, 'a');
  const test::MemoryObject there("object_test/b.bin", bytes);
  StoredObject object(there.address());
  VSIFCloseL(VSIFOpenL("/vsimem/object_test/b.bin", "wb"));  // empty now
  EXPECT_THROW(object.read_some(0, bytes.data(), 1000), core::Error);
}

TEST(StoredObject, NothingListensThatIsASoonAndClearError) {
  CPLSetConfigOption("AWS_NO_SIGN_REQUEST", "YES");
  CPLSetConfigOption("AWS_S3_ENDPOINT", "127.0.0.1:9");
  CPLSetConfigOption("AWS_HTTPS", "NO");
  CPLSetConfigOption("AWS_VIRTUAL_HOSTING", "NO");
  for (const char* address : {"s3://bucket/a.laz", "http://127.0.0.1:9/a.laz"}) try {
      StoredObject object(address);
      FAIL() << "opened";
    } catch (const core::Error& e) {
      EXPECT_EQ(e.where(), address);
      EXPECT_NE(std::string(e.what()).find("connect"), std::string::npos) << e.text();
      EXPECT_NE(e.hint().find("AWS_S3_ENDPOINT"), std::string::npos) << e.text();
    }
  for (const char* key : {"AWS_NO_SIGN_REQUEST", "AWS_S3_ENDPOINT", "AWS_HTTPS", "AWS_VIRTUAL_HOSTING"}) CPLSetConfigOption(key, nullptr);
}

TEST(ObjectState, IsTheSizeWhereTheStoreStatesNoVersion) {
  const test::MemoryObject there("object_test/c.bin", std::string(77, 'c'));
  EXPECT_EQ(object_state(there.address()).bytes, 77u);
  EXPECT_TRUE(object_state(there.address()).version.empty());
}

TEST(StoreFile, IsThereWholeOrAnErrorWithItsAddress) {
  const test::TemporaryFolder folder;
  const std::string bytes(20'000'000, 'x');  // more than is copied at once
  for (const std::string& some : {bytes, std::string("a"), std::string()}) {
    test::write_bytes(folder / "a.bin", some);
    EXPECT_EQ(store_file(folder / "a.bin", "/vsimem/object_test/copy.bin", ""), some.size());
    EXPECT_EQ(StoredObject("/vsimem/object_test/copy.bin").size(), some.size());
  }
  EXPECT_THROW(store_file(folder / "none", "/vsimem/object_test/copy.bin", ""), core::Error);
  try {
    store_file(folder / "a.bin", "http://127.0.0.1:9/a.bin", "run it again");
    FAIL() << "written";
  } catch (const core::SystemError& e) {
    EXPECT_EQ(e.where(), "http://127.0.0.1:9/a.bin");
    EXPECT_NE(e.hint().find("run it again"), std::string::npos);
  }
}

TEST(OpenAddress, AllowsItsOwnNameAsLongAsItLives) {
  const char* const key = "CPL_VSIL_CURL_ALLOWED_FILENAME";
  {
    const OpenAddress open("s3://bucket/a.laz");
    EXPECT_STREQ(CPLGetConfigOption(key, ""), "/vsis3/bucket/a.laz");
  }
  EXPECT_STREQ(CPLGetConfigOption(key, ""), "");
}

}  // namespace
}  // namespace swath::io
