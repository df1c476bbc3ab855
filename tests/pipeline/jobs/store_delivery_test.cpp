// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/store_delivery.h"

#include <cstdlib>
#include <utility>

#include "io/store/input_file.h"
#include "tests/pipeline/cloud_case.h"

namespace swath::pipeline {
namespace {

struct StoredCase : CloudCase {
  StoredCase() {
    // A store of which no server is there.
    for (const auto& [key, value] : {std::pair{"AWS_S3_ENDPOINT", "127.0.0.1:9"}, {"AWS_NO_SIGN_REQUEST", "YES"}, {"AWS_HTTPS", "NO"}})
      ::setenv(key, value, 1);
    ::setenv("AWS_VIRTUAL_HOSTING", "FALSE", 1);
    add(square(500, easting, northing, 40, 300), "a.las", "EPSG:32632");
    test::write_bytes(folder / "survey.toml", survey);
    test::write_bytes(folder / "p.toml", copy_stages);
    request.config = folder / "p.toml";
    request.survey = folder / "survey.toml";
    request.output = folder / "out";
    request.threads = 1;
  }
  Copied deliver(const fs::path& store) const {
    Plan plan = make_plan(request);
    Progress progress(Voice::quiet);
    Copied copied;
    run_to_store(plan, progress, "test", store, copied);
    return copied;
  }
  Request request;
};

std::string stored(const fs::path& address) {
  io::InputFile file(address);
  std::string out(file.size(), '\0');
  file.read_some(0, out.data(), out.size());
  return out;
}

TEST(StoreDelivery, EveryProductIsInTheStoreWhole) {
  const StoredCase c;
  const Copied copied = c.deliver("/vsimem/store_delivery/a/");
  std::uint64_t files = 0, bytes = 0;
  for (const auto& at : fs::recursive_directory_iterator(c.request.output)) {
    if (!at.is_regular_file()) continue;
    ++files, bytes += at.file_size();
    const fs::path there = "/vsimem/store_delivery/a/" + at.path().lexically_relative(c.request.output).string();
    EXPECT_TRUE(stored(there) == test::read_bytes(at.path())) << there;
  }
  EXPECT_GT(files, 2u);
  EXPECT_EQ(copied.files, files);
  EXPECT_EQ(copied.bytes, bytes);
  EXPECT_FALSE(copied.is_earlier);
}

TEST(StoreDelivery, WhatWasNotCopiedIsCopiedAloneByTheSameCommand) {
  const StoredCase c;
  EXPECT_THROW(c.deliver("/vsicurl/http://127.0.0.1:9/a"), core::Error);
  EXPECT_FALSE(fs::exists(c.request.output)) << "refused before the run";
  for (int times = 0; times < 2; ++times) try {
      c.deliver("s3://bucket/a");
      FAIL() << "written";
    } catch (const core::SystemError& e) {
      EXPECT_EQ(e.where().find("s3://bucket/a/"), 0u) << e.text();
      EXPECT_NE(e.hint().find(c.request.output.string()), std::string::npos) << e.text();
    }
  const std::string report = test::read_bytes(c.request.output / "report.json");
  EXPECT_TRUE(c.deliver("/vsimem/store_delivery/b").is_earlier);
  EXPECT_EQ(test::read_bytes(c.request.output / "report.json"), report) << "not run again";
  EXPECT_FALSE(c.deliver("/vsimem/store_delivery/b").is_earlier) << "all were copied: a new run";
}

TEST(StoreDelivery, AProductThatChangedMeanwhileIsMadeAnew) {
  const StoredCase c;
  EXPECT_THROW(c.deliver("s3://bucket/a"), core::SystemError);
  const std::string whole = test::read_bytes(c.request.output / "points/index.vpc");
  test::write_bytes(c.request.output / "points/index.vpc", "spoilt");
  EXPECT_FALSE(c.deliver("/vsimem/store_delivery/c").is_earlier);
  EXPECT_EQ(stored("/vsimem/store_delivery/c/points/index.vpc").size(), whole.size());
}

TEST(StoreDelivery, APlaceThatCannotBeWrittenIsRefused) {
  for (const char* name : {"out", "/data/out", "http://host/a", "https://host/a", "/vsicurl/https://host/a", "s3://", "/vsis3/", ""})
    EXPECT_THROW(check_store(name), core::Error) << name;
  for (const char* name : {"s3://bucket", "s3://bucket/a/", "gs://bucket/a", "az://container/a", "/vsis3/bucket/a"})
    EXPECT_NO_THROW(check_store(name)) << name;
}

}  // namespace
}  // namespace swath::pipeline
