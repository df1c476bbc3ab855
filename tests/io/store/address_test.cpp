// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/store/address.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace swath::io {
namespace {

TEST(Address, StoresAndServersAreKnownByTheirScheme) {
  for (const char* name : {"s3://b/a.laz", "gs://b/a.laz", "az://c/a.laz", "https://h/a.laz", "http://h:80/a.laz", "/vsis3/b/a.laz",
                           "s3:/b/a.laz", "/vsigs/b/a.laz", "/vsiaz/c/a.laz", "/vsicurl/https://h/a.laz", "/vsimem/a.laz"})
    EXPECT_TRUE(is_address(name)) << name;
  for (const char* name : {"a.laz", "/data/a.laz", "s3/a.laz", "S3://b/a.laz", "data/s3://b/a.laz", "/vsisite/a.laz", "/vsizip/a.zip/a.laz",
                           "/vsistdin/", "ftp://h/a.laz", "file:///a.laz", ""})
    EXPECT_FALSE(is_address(name)) << name;
}

TEST(Address, GdalNamesThemByItsFileSystems) {
  EXPECT_EQ(gdal_name("s3://bucket/folder/a.laz"), "/vsis3/bucket/folder/a.laz");
  EXPECT_EQ(gdal_name("gs://bucket/a.laz"), "/vsigs/bucket/a.laz");
  EXPECT_EQ(gdal_name("az://container/a.laz"), "/vsiaz/container/a.laz");
  EXPECT_EQ(gdal_name("https://host/a//b.laz"), "/vsicurl/https://host/a//b.laz");
  EXPECT_EQ(gdal_name("/vsis3/bucket/a.laz"), "/vsis3/bucket/a.laz");
  EXPECT_EQ(gdal_name("s3:/bucket/a.laz"), "/vsis3/bucket/a.laz");
  EXPECT_EQ(gdal_name("https:/host/a.laz"), "/vsicurl/https://host/a.laz");
}

TEST(Address, PasswordsAndSignaturesAreNotShown) {
  EXPECT_EQ(without_access("HTTP error code: 503 - https://b.s3.x/a.laz?X-Amz-Signature=abc&x=1. Retrying"),
            "HTTP error code: 503 - https://b.s3.x/a.laz?... Retrying");
  EXPECT_EQ(without_access("https:/me:secret@host/a.laz"), "https:/host/a.laz");
  EXPECT_EQ(without_access("/vsicurl/http://me@host/a?b http://c/d?e=f"), "/vsicurl/http://host/a?... http://c/d?...");
  for (const char* name : {"https://host/a@b.laz", "s3://bucket/what?.laz", "http", "no http:here?", "a?b"})
    EXPECT_EQ(without_access(name), name);
  EXPECT_NO_THROW(gdal_name("https://host/a@b.laz"));
  for (const char* name : {"https://host/a.laz?sig=abc", "https://me:secret@host/a.laz", "/vsicurl/https://host/a.laz?sig=abc"}) try {
      gdal_name(name);
      ADD_FAILURE() << name;
    } catch (const core::Error& e) {
      EXPECT_EQ(e.where().find("abc"), std::string::npos) << e.where();
      EXPECT_EQ(e.where().find("secret"), std::string::npos) << e.where();
    }
}

TEST(Address, IsShownWithBothSlashes) {
  EXPECT_EQ(shown_name("s3:/bucket/a.laz"), "s3://bucket/a.laz");
  EXPECT_EQ(shown_name("https://host/a//b.laz"), "https://host/a//b.laz");
  EXPECT_EQ(shown_name("/vsis3/bucket/a.laz"), "/vsis3/bucket/a.laz");
  EXPECT_EQ(shown_name("a//b.laz"), "a//b.laz");
}

TEST(Address, StaysAsItIsWhereLocalNamesAreMadeFull) {
  EXPECT_EQ(full_name("s3://b/../a.laz").string(), "s3://b/../a.laz");
  EXPECT_EQ(full_name("/data/./a.laz").string(), "/data/a.laz");
  EXPECT_TRUE(full_name("a.laz").is_absolute());
}

}  // namespace
}  // namespace swath::io
