// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/result_visitors.h"

#include <gtest/gtest.h>

#include <limits>

namespace swath::core {
namespace {

struct Pair {
  int first = 0, second = 0;
  double rms = std::numeric_limits<double>::quiet_NaN();
};
template <class V>
void describe(const Pair& r, V& v) {
  v.result("first", r.first, "First line.");
  v.result("second", r.second, "Second line.");
  v.result("rms_m", r.rms, metres(3).in_summary(), "RMS difference.");
}

struct Made {
  Changed ground;
  LeftOut outside;
  std::uint64_t doubtful = 0;
  std::optional<double> sigma;
  double unknown = std::numeric_limits<double>::quiet_NaN();
  Eigen::Vector3d offset = Eigen::Vector3d(1, 2, 3);
  std::string verdict;
  std::vector<Pair> pairs;
  std::optional<Pair> worst;
  std::vector<std::pair<std::string, Pair>> checks;
};
template <class V>
void describe(const Made& r, V& v) {
  v.result("ground", r.ground, "Returns classified as ground.");
  v.result("outside", r.outside, if_any(), "Returns outside.");
  v.result("doubtful", r.doubtful, if_any(), "Returns in doubt.");
  v.result("sigma", r.sigma, metres(2).limited_by("sigma"), "Sigma.");
  v.result("unknown", r.unknown, metres().always(), "A figure that is null where it is unknown.");
  v.result("offset_m", r.offset, metres(), "Offset.");
  v.result("verdict", r.verdict, "Verdict.");
  v.tables("pairs", r.pairs, "Pairs of lines.");
  v.table("worst", r.worst, "The worst pair.");
  v.named_tables("checks", r.checks, "Checks.");
}

TEST(ResultVisitors, AReportHoldsWhatHasAValueInTheOrderOfDeclaration) {
  Made made;
  made.ground = 7;
  made.verdict = "good";
  made.pairs = {{1, 2, 0.5}, {2, 3}};
  made.checks = {{"roll", {4, 5, 0.25}}};
  const Value v = reported(made);
  std::string keys;
  for (const auto& [key, value] : v.members()) keys += key + " ";
  EXPECT_EQ(keys, "ground unknown offset_m verdict pairs checks ");  // neither counts of 0, nor what has no value
  EXPECT_EQ(v.find("ground")->as_int(), 7);
  EXPECT_TRUE(v.find("unknown")->is_null());
  EXPECT_EQ(v.find("offset_m")->items()[2].as_number(), 3.0);
  EXPECT_EQ(v.find("pairs")->items()[0].find("rms_m")->as_number(), 0.5);
  EXPECT_EQ(v.find("pairs")->items()[1].find("rms_m"), nullptr);
  EXPECT_EQ(v.find("checks")->find("roll")->find("second")->as_int(), 5);
  made.outside = 2;
  made.sigma = 0.125;
  made.worst = Pair{8, 9};
  EXPECT_EQ(reported(made).find("outside")->as_int(), 2);
  EXPECT_EQ(reported(made).find("sigma")->as_number(), 0.125);
  EXPECT_EQ(reported(made).find("worst")->find("first")->as_int(), 8);
}

TEST(ResultVisitors, AFigureWithALimitIsNullWhereItIsNotFiniteAndLeftOutWhereItIsNotComputed) {
  Made made;
  EXPECT_EQ(reported(made).find("sigma"), nullptr);
  made.sigma = std::numeric_limits<double>::quiet_NaN();
  ASSERT_NE(reported(made).find("sigma"), nullptr);
  EXPECT_TRUE(reported(made).find("sigma")->is_null());
}

struct Either {
  std::optional<std::string> why;
  std::optional<Pair> pair;
};
template <class V>
void describe(const Either& r, V& v) {
  v.result("pair", r.why, "Why there is none.");
  v.table("pair", r.pair, "A pair.");
}

TEST(ResultVisitors, TheSchemaAllowsNullWhereTheReportHasItAndEitherOfTwoForms) {
  const Value made = result_schema([](ResultVisitor& v) { describe(Made{}, v); });
  const Value& properties = *made.find("properties");
  for (const char* key : {"unknown", "sigma"}) {
    const Value& type = *properties.find(key)->find("type");
    ASSERT_TRUE(type.is_array()) << key;
    EXPECT_EQ(type.items()[1].as_text(), "null");
  }
  EXPECT_TRUE(properties.find("offset_m")->find("items")->find("type")->is_array());
  const Value either = result_schema([](ResultVisitor& v) { describe(Either{}, v); });
  const Value* any = either.find("properties")->find("pair")->find("anyOf");
  ASSERT_NE(any, nullptr);
  EXPECT_EQ(any->items()[0].find("type")->as_text(), "string");
  EXPECT_EQ(any->items()[1].find("type")->as_text(), "object");
}

TEST(ResultVisitors, CountsOfSeveralTilesAddUp) {
  Made made;
  made.ground = 7;
  made.doubtful = 1;
  Tally tally;
  count_results(made, tally);
  count_results(made, tally);
  EXPECT_EQ(tally.of("ground"), 14u);
  EXPECT_EQ(tally.of("doubtful"), 2u);
  EXPECT_EQ(tally.value().find("outside"), nullptr);
  EXPECT_EQ(tally.value().find("offset_m"), nullptr);
}

TEST(ResultVisitors, EveryKeyIsDocumentedAndInTheSchema) {
  const Made sample;
  const auto docs = document_results(described_results(sample));
  const auto of = [&](std::string_view path) -> const ResultDoc& {
    for (const ResultDoc& d : docs)
      if (d.path == path) return d;
    throw std::runtime_error(std::string(path));
  };
  EXPECT_EQ(of("ground").fate, Fate::changed);
  EXPECT_EQ(of("outside").fate, Fate::left_out);
  EXPECT_EQ(of("pairs[].rms_m").form.unit, "m");
  EXPECT_EQ(of("pairs[].rms_m").form.audience, Audience::summary);
  EXPECT_EQ(of("checks.*.first").doc, "First line.");
  EXPECT_EQ(of("worst.second").shape, "integer");
  const std::string page = result_table_markdown(described_results(sample));
  EXPECT_NE(page.find("| `sigma` | number | m |  | Sigma. Judged by `run.limits.sigma`. |"), std::string::npos) << page;
  const Value schema = result_schema(described_results(sample));
  const Value& properties = *schema.find("properties");
  EXPECT_EQ(properties.find("pairs")->find("items")->find("properties")->find("rms_m")->find("type")->as_text(), "number");
  EXPECT_EQ(properties.find("offset_m")->find("type")->as_text(), "array");
  EXPECT_EQ(properties.find("checks")->find("additionalProperties")->find("properties")->find("first")->find("type")->as_text(), "integer");
}

TEST(ResultVisitors, TextsRoundAndNameTheUnit) {
  EXPECT_EQ(shown(Value(0.02123), metres(3)), "0.021 m");
  EXPECT_EQ(shown(Value(0.021234567), plain()), "0.02123");
  EXPECT_EQ(shown(Value(12345), Form{}), "12345");
  EXPECT_EQ(shown(Value(0.25), share(2)), "0.25");
  EXPECT_EQ(shown(Value(0.0000123), share(4)), "1.2e-05");  // a small share is not none
  EXPECT_EQ(shown(Value(0.00021), share(4)), "0.00021");
  EXPECT_EQ(shown(Value(0.0), share(4)), "0.0000");
  EXPECT_EQ(shown(Value(0.012), percent(1)), "0.012 %");
}

}  // namespace
}  // namespace swath::core
