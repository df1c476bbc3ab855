// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/describe_tables.h"

#include "core/error.h"
#include "io/survey/info.h"
#include "io/text/npy.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(DescribeTables, TextAndNumpy) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.csv", "t,r\n1,5\n2,nan\n3,-7\n");
  core::Value facts = describe_file(folder / "a.csv");
  EXPECT_EQ(facts.find("format")->as_text(), "delimited text");
  EXPECT_EQ(facts.find("rows")->as_int(), 3);
  EXPECT_EQ(facts.find("columns")->items()[1].find("span")->items()[0].as_number(), -7);
  EXPECT_NE(info_text(facts).find("warning: column r holds 1"), std::string::npos) << info_text(facts);
  EXPECT_NE(info_text(facts).find("columns\n  t  1 to 3\n  r  -7 to 5\n"), std::string::npos) << info_text(facts);
  test::write_bytes(folder / "a.csv", "t,r\n1,5\n2,x\n");
  EXPECT_NE(info_text(describe_file(folder / "a.csv")).find("reading stopped"), std::string::npos);

  const double v[2] = {1.5, 2.5};
  NpyWriter w(folder / "a.npy", {{"t", "f8"}});
  w.append({v}, 2);
  w.commit();
  facts = describe_file(folder / "a.npy");
  EXPECT_EQ(facts.find("rows")->as_int(), 2);
  EXPECT_EQ(facts.find("columns")->items()[0].find("type")->as_text(), "<f8");
  EXPECT_EQ(facts.find("columns")->items()[0].find("span")->items()[1].as_number(), 2.5);
}

TEST(DescribeTables, EventsByNameAndThoseOfOneTime) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "events.csv", "image,gps_sow_s\nIMG_1.jpg,100.5\nIMG_2.jpg,102.5\nIMG_3.jpg,102.5\nIMG_4.jpg,100.5\n");
  const core::Value facts = describe_file(folder / "events.csv");
  EXPECT_EQ(facts.find("rows")->as_int(), 4);
  EXPECT_EQ(facts.find("columns")->items().size(), 2u);
  EXPECT_EQ(facts.find("columns")->items()[1].find("span")->items()[1].as_number(), 102.5);
  ASSERT_EQ(facts.find("warnings")->items().size(), 1u) << info_text(facts);
  EXPECT_EQ(facts.find("warnings")->items()[0].as_text(), "events at the time of another one: 2 (lines 3 and 4)");
  // Numbered events have the span of their numbers; a table that is not of events may repeat what it likes.
  test::write_bytes(folder / "events.csv", "id,gps_sow_s\n7,1\n9,2\n");
  EXPECT_EQ(describe_file(folder / "events.csv").find("columns")->items()[0].find("span")->items()[1].as_number(), 9);
  test::write_bytes(folder / "a.csv", "t,r\n1,5\n1,6\n");
  EXPECT_TRUE(describe_file(folder / "a.csv").find("warnings")->items().empty());
}

TEST(DescribeTables, RecordsAtOneTimeAreNamed) {
  const test::TemporaryFolder folder;
  const auto said = [&](const std::string& text) {
    test::write_bytes(folder / "a.csv", text);
    return info_text(describe_file(folder / "a.csv"));
  };
  const std::string gnss = "gps_sow_s,lat_deg,lon_deg,h_ell_m\n474006,47.9,10.5,1127\n474007,47.9,10.5,1127\n";
  EXPECT_EQ(said(gnss).find("warning"), std::string::npos) << said(gnss);
  std::string text = said(gnss + "474007,47.9,10.5,1127\n474007,47.9,10.5,1127\n");
  EXPECT_NE(text.find("2 records repeat the time before them: written twice"), std::string::npos) << text;
  text = said(gnss + "474006,47.9,10.5,1127\n474007,47.9,10.5,1127\n");
  EXPECT_NE(text.find("time goes back 1 time: "), std::string::npos) << text;
  text = said("gps_sow_s,lat_deg,lon_deg,h_ell_m\n604798,47.9,10.5,1127\n604799,47.9,10.5,1127\n0,47.9,10.5,1127\n");
  EXPECT_EQ(text.find("time goes back"), std::string::npos) << "the week begins anew: " << text;
  text = said("time,gx,gy,gz,ax,ay,az\n1,0,0,0,0,0,-9.8\n1,0,0,0,0,0,-9.8\n2,0,0,0,0,0,-9.8\n");
  EXPECT_NE(text.find("1 record repeats the time before it"), std::string::npos) << text;
  text = said("gps_sow_s,line,scan_angle_deg,range_m\n474009,1,-20.5,500.1\n474009,1,-20.5,510.1\n");
  EXPECT_EQ(text.find("repeat"), std::string::npos) << "two returns of a pulse: " << text;
}

}  // namespace
}  // namespace swath::io
