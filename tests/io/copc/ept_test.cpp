// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/copc/ept.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/text/value_file.h"
#include "tests/io/copc/copc_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

struct OneIndex {
  test::TemporaryFolder folder;
  std::filesystem::path index = folder / "cloud" / "ept.json";
  OneIndex() {
    const LasHeader h = test::sample_header(6);
    test::write_copc_sample(folder / "a.copc.laz", h, test::copc_points(h, 150000));
    test::write_ept(folder / "cloud", folder / "a.copc.laz");
  }
  /// Changes a member of a JSON file.
  void set(const std::filesystem::path& file, const char* key, core::Value v) const {
    core::Value tree = read_value_file(file);
    tree[key] = std::move(v);
    write_text_file(file, to_json(tree));
  }
  std::string fault() const {
    PointFile like;
    like.file = "cloud/ept.json";
    try {
      ept_files(index, like);
    } catch (const core::Error& e) {
      return e.text();
    }
    return {};
  }
};

TEST(Ept, NodesAreFilesWithTheCrsAndTheCubeOfTheIndex) {
  const OneIndex one;
  PointFile like;
  like.file = "cloud/ept.json";
  like.line = 7;
  std::vector<PointFile> files = ept_files(one.index, like);
  ASSERT_GT(files.size(), 4u);
  EXPECT_EQ(files[0].file, "cloud/ept-data/0-0-0-0.laz");
  EXPECT_EQ(files[0].crs, "EPSG:25832");
  EXPECT_EQ(files[1].line, 7);
  const auto root = ept_node(one.folder / files[0].file.string()), below = ept_node(one.folder / files[1].file.string());
  ASSERT_TRUE(root && below);
  EXPECT_EQ(below->level, 1);
  EXPECT_DOUBLE_EQ(below->spacing * 2.0, root->spacing);
  EXPECT_NEAR(below->high.x() - below->low.x(), 0.5 * (root->high.x() - root->low.x()), 1e-6);
  EXPECT_FALSE(ept_node(one.folder / "a.copc.laz"));
  like.crs = "EPSG:25832+7837";
  EXPECT_EQ(ept_files(one.index, like)[0].crs, like.crs) << "the survey has the last word";
  one.set(one.index, "srs", parse_json(R"({"authority": "EPSG", "horizontal": "25832", "vertical": "5783"})", "test"));
  like.crs.clear();
  EXPECT_EQ(ept_files(one.index, like)[0].crs, "EPSG:25832+5783");
  one.set(one.index, "srs", parse_json(R"({"wkt": "PROJCS[..."})", "test"));
  EXPECT_EQ(ept_files(one.index, like)[0].crs, "PROJCS[...");
}

TEST(Ept, PagesOfTheHierarchyAreFollowed) {
  const OneIndex one;
  const auto pages = one.index.parent_path() / "ept-hierarchy";
  core::Value root = read_value_file(pages / "0-0-0-0.json"), below = core::Value::object();
  for (auto& [name, points] : root.members())
    if (name.starts_with("1-0-0-")) below[name] = points, points = -1;
  ASSERT_GT(below.members().size(), 0u);
  write_text_file(pages / "0-0-0-0.json", to_json(root));
  EXPECT_NE(one.fault().find("page of the EPT hierarchy is missing"), std::string::npos) << one.fault();
  for (const auto& [name, points] : below.members()) {
    core::Value page = core::Value::object();
    page[name] = points;
    write_text_file(pages / (name + ".json"), to_json(page));
  }
  EXPECT_EQ(one.fault(), "");
  const std::string name = below.members()[0].first;
  one.set(pages / (name + ".json"), name.c_str(), -1);
  EXPECT_NE(one.fault().find("listed twice"), std::string::npos) << one.fault();
}

TEST(Ept, WhatIsMissingOrWrongIsOneErrorThatNamesIt) {
  struct Case {
    const char *expected, *key;
    core::Value value;
  };
  const OneIndex one;
  const core::Value whole = read_value_file(one.index);
  for (const Case& c : {Case{"are not LAZ files: binary", "dataType", "binary"}, Case{"ept.json says 7", "points", 7},
                        Case{"is not a number above 0", "span", 0}, Case{"are not a cube", "bounds", core::Value::array()}}) {
    one.set(one.index, c.key, c.value);
    EXPECT_NE(one.fault().find(c.expected), std::string::npos) << one.fault();
    write_text_file(one.index, to_json(whole));
  }
  core::Value cut = whole;
  std::erase_if(cut.members(), [](const auto& m) { return m.first == "span"; });
  write_text_file(one.index, to_json(cut));
  EXPECT_NE(one.fault().find("the EPT index has no span"), std::string::npos) << one.fault();
  write_text_file(one.index, to_json(whole));
  const auto page = one.index.parent_path() / "ept-hierarchy" / "0-0-0-0.json";
  const std::string pages = read_text_file(page);
  for (const char* name : {"1-2-0-0", "1-0-0", "1-0-0-0-0", "a", "01-0-0-0"}) {
    one.set(page, name, 5);
    EXPECT_NE(one.fault().find("is not a node"), std::string::npos) << name << one.fault();
    write_text_file(page, pages);
  }
  one.set(page, "0-0-0-0", "many");
  EXPECT_NE(one.fault().find("has no number of points"), std::string::npos) << one.fault();
  write_text_file(page, pages);
  std::filesystem::remove(one.index.parent_path() / "ept-data" / "0-0-0-0.laz");
  EXPECT_NE(one.fault().find("the EPT node 0-0-0-0 of"), std::string::npos) << one.fault();
  EXPECT_NE(one.fault().find("is missing"), std::string::npos) << one.fault();
}

TEST(Ept, AVirtualPointCloudStandsForItsFiles) {
  const OneIndex one;
  const auto list = one.folder / "a.vpc";
  const auto write = [&](const std::string& href) {
    write_text_file(list, R"({"type": "FeatureCollection", "features": [{"assets": {"data": {"href": ")" + href + R"("}}}]})");
  };
  Survey s;
  s.folder = one.folder.path();
  s.points.resize(1);
  const auto expand = [&] {
    s.points.resize(1);
    s.points[0].file = "a.vpc";
    expand_clouds(s);
    return s.points[0].file;
  };
  write("./a.copc.laz");
  EXPECT_EQ(expand(), "a.copc.laz");
  write("file://" + (one.folder / "a.copc.laz").string());
  EXPECT_EQ(expand(), one.folder / "a.copc.laz");
  write("./b.laz");
  EXPECT_THROW(expand(), core::Error);
  write("https://somewhere/a.laz");
  EXPECT_THROW(expand(), core::Error);
  // A folder that looks like an address, beside the list.
  std::filesystem::create_directories(one.folder / "https:/somewhere");
  write_text_file(one.folder / "https:/somewhere/a.laz", "");
  for (const char* name : {"./https:/somewhere/a.laz", "https:/somewhere/a.laz", "x/../https:/somewhere/a.laz", "/vsicurl/a.laz"}) {
    write(name);
    EXPECT_THROW(expand(), core::Error) << name;
  }
  write_text_file(list, R"({"features": []})");
  EXPECT_THROW(expand(), core::Error);
  write_text_file(list, R"({"features": [{"assets": 3}]})");
  EXPECT_THROW(expand(), core::Error);
  write_text_file(list, "{}");
  EXPECT_THROW(expand(), core::Error);
  write("a.copc.laz");
  s.points.resize(2);
  s.points[0].file = "a.vpc", s.points[1].file = "a.copc.laz";
  EXPECT_THROW(expand_clouds(s), core::Error) << "twice";
}

}  // namespace
}  // namespace swath::io
