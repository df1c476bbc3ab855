// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/option_visitors.h"

#include <gtest/gtest.h>

namespace swath::core {
namespace {

struct Inner {
  Seconds pause{1.0};
};
template <class V>
void describe(Inner& i, V& v) {
  v.option("pause", i.pause, at_least(0), "Pause.");
}
struct Sample {
  Metres cell{1.0};
  Metres window{18.0};
  double slope = 0.15;
  std::array<Metres, 3> lever{};
  std::optional<int> week;
  std::vector<Inner> parts;
  Inner inner;
};
template <class V>
void describe(Sample& s, V& v) {
  v.option("cell", s.cell, above(0.0), "Side of one cell.", "Paper 1");
  v.option("window", s.window, above(0.0), "Radius.");
  v.option("slope", s.slope, within(0, 5), "Steepest.");
  v.option("lever", s.lever, "Lever arm.");
  v.option("week", s.week, "Week.");
  v.tables("part", s.parts, "Parts.");
  v.table("inner", s.inner, "Inner.");
  v.check(s.window >= s.cell, "window must span at least one cell");
}

Value object(std::initializer_list<Value::Member> members) { return Value(Value::Object(members)); }

TEST(OptionVisitors, ReadsValuesTablesAndLists) {
  Sample s;
  std::vector<Fault> faults;
  Value lever = Value::array();
  for (const char* t : {"1 m", "2 cm", "-3 mm"}) lever.push(t);
  Value parts = Value::array();
  parts.push(object({{"pause", "5 ms"}}));
  parts.push(object({}));
  read_options(described(s),
               object({{"cell", "50 cm"}, {"lever", lever}, {"week", 2317}, {"part", parts}, {"inner", object({{"pause", "2 s"}})}}), "",
               faults);
  EXPECT_TRUE(faults.empty());
  EXPECT_DOUBLE_EQ(s.cell.value, 0.5);
  EXPECT_DOUBLE_EQ(s.lever[2].value, -0.003);
  EXPECT_EQ(s.week, 2317);
  ASSERT_EQ(s.parts.size(), 2u);
  EXPECT_DOUBLE_EQ(s.parts[0].pause.value, 0.005);
  EXPECT_DOUBLE_EQ(s.inner.pause.value, 2.0);
}

TEST(OptionVisitors, CollectsAllFaultsAtOnce) {
  Sample s;
  std::vector<Fault> faults;
  read_options(described(s), object({{"cell", 1.0}, {"slope", 7.0}, {"widnow", "3 m"}, {"inner", object({{"puase", "1 s"}})}}), "stage[1]",
               faults);
  ASSERT_EQ(faults.size(), 4u);
  std::string all;
  for (const Fault& f : faults) all += f.text() + "\n";
  EXPECT_NE(all.find("stage[1].cell: 1: no unit"), std::string::npos) << all;
  EXPECT_NE(all.find("allowed: 0 to 5"), std::string::npos);
  EXPECT_NE(all.find("did you mean 'window'"), std::string::npos);
  EXPECT_NE(all.find("stage[1].inner.puase"), std::string::npos);
  EXPECT_THROW(throw_if_any(faults), Error);
}

TEST(OptionVisitors, ConditionsBetweenOptions) {
  Sample s;
  std::vector<Fault> faults;
  read_options(described(s), object({{"cell", "20 m"}}), "", faults);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].what, "window must span at least one cell");
}

TEST(OptionVisitors, EffectiveValuesReadBackAndFingerprintFollows) {
  Sample s;
  s.slope = 0.1;
  s.parts.resize(1);
  const std::string before = fingerprint_of(described(s));
  Sample t;
  std::vector<Fault> faults;
  read_options(described(t), effective_values(described(s)), "", faults);
  EXPECT_TRUE(faults.empty());
  EXPECT_EQ(fingerprint_of(described(t)), before);
  t.slope = 0.1000001;
  EXPECT_NE(fingerprint_of(described(t)), before);
}

struct Files {
  std::filesystem::path file;
};
template <class V>
void describe(Files& f, V& v) {
  v.option("file", f.file, "A file, or an address in an object store.");
}

TEST(OptionVisitors, AddressesStayAsTheyAreWritten) {
  Files f{"s3://bucket/folder/a.laz"}, other{"s3:/bucket/folder/a.laz"};
  EXPECT_EQ(effective_values(described(f)).find("file")->as_text(), "s3://bucket/folder/a.laz");
  EXPECT_NE(fingerprint_of(described(f)), fingerprint_of(described(other)));
}

TEST(OptionVisitors, DocumentsAndSchema) {
  Sample s;
  const std::string table = option_table_markdown(described(s));
  EXPECT_NE(table.find("| `cell` | length | `\"1 m\"` | > 0 m | Side of one cell. | Paper 1 |"), std::string::npos) << table;
  EXPECT_NE(table.find("`part[].pause`"), std::string::npos);
  const Value schema = schema_of(described(s));
  EXPECT_FALSE(schema.find("additionalProperties")->as_bool());
  EXPECT_EQ(schema.find("properties")->find("slope")->find("maximum")->as_number(), 5.0);
  EXPECT_EQ(schema.find("properties")->find("part")->find("type")->as_text(), "array");
}

}  // namespace
}  // namespace swath::core
