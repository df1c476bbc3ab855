// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/table_start.h"

#include "core/error.h"
#include "io/text/delimited.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

std::vector<std::vector<double>> read_all(const std::filesystem::path& file, const std::vector<std::string>& columns) {
  const DelimitedLayout layout = inspect_delimited(file);
  std::vector<size_t> at;
  for (const std::string& c : columns) at.push_back(column_of(layout, c, file));
  DelimitedReader reader(file, layout, at);
  std::vector<std::vector<double>> out;
  std::vector<double> row(columns.size());
  while (reader.next(row.data())) out.push_back(row);
  return out;
}

class TableStarts : public ::testing::Test {
 protected:
  std::filesystem::path made(const std::string& text) {
    test::write_bytes(folder_ / "a.csv", text);
    return folder_ / "a.csv";
  }
  core::Error error_of(const std::string& text, const std::vector<std::string>& columns) {
    try {
      read_all(made(text), columns);
    } catch (const core::Error& e) {
      return e;
    }
    ADD_FAILURE() << "no error for: " << text;
    return core::Error("none");
  }
  test::TemporaryFolder folder_;
};

using Rows = std::vector<std::vector<double>>;

TEST_F(TableStarts, ADescriptionAboveTheTableIsPassedOver) {
  const Rows rows{{1, 2, 3}, {4, 5, 6}};
  const std::vector<std::string> named{"GPSTime", "H-Ell", "Roll"};
  const std::string table = "1 2 3\n4 5 6\n";
  // Inertial Explorer: project, names, units of some columns.
  EXPECT_EQ(
      read_all(made("Project:  flight\nProgram:  IE Version 8.90\nSource:  TC\n\n GPSTime  H-Ell  Roll\n (sec) (deg)\n" + table), named),
      rows);
  // Units below the names, one for each column.
  EXPECT_EQ(read_all(made("GPSTime,H-Ell,Roll\ns,m,deg\n1,2,3\n4,5,6\n"), named), rows);
  EXPECT_EQ(read_all(made("a flight here\nGPSTime H-Ell Roll\n(sec) [m] (deg)\n" + table), named), rows);
  EXPECT_EQ(read_all(made("// rate: 100\n// firmware 4.2.0\nGPSTime\tH-Ell\tRoll\n1\t2\t3\n4\t5\t6\n"), named), rows);
  // POSPac: names of several words between commas, records between blanks.
  const auto pospac =
      made("POSPAC MMS SBET ASCII EXPORT\nMission: 1\nTIME, ELLIPSOID HEIGHT, ROLL\n(time in Sec, height in Meters)\n\n" + table);
  EXPECT_EQ(read_all(pospac, {"TIME", "ELLIPSOID HEIGHT", "ROLL"}), rows);
  EXPECT_EQ(inspect_delimited(pospac).data_line, 6u);
  // Without names the columns have numbers.
  EXPECT_EQ(read_all(made("made by a logger\non a day in June\n" + table), {"1", "2", "3"}), rows);
}

TEST_F(TableStarts, NamesOfSeveralWordsBetweenRunsOfBlanks) {
  const Rows rows{{1, 2, 3}, {4, 5, 6}};
  const std::string names = "   TIME   ELLIPSOID HEIGHT  ROLL \n", table = "  1  2 3\n  4  5 6\n";
  for (const std::string& text :
       {names + table, "POSPac MMS ASCII Export\nMission: 1\n" + names + "  (time in Sec, height in Meters)\n\n" + table})
    EXPECT_EQ(read_all(made(text), {"TIME", "ELLIPSOID HEIGHT", "ROLL"}), rows) << text;
}

TEST_F(TableStarts, UnitsBelowTheNamesAreThoseOfTheirColumns) {
  using Units = std::vector<std::string>;
  const auto units = [&](const std::string& text) { return column_units(made(text)); };
  EXPECT_EQ(units("Project: a\n\n  GPSTime   H-Ell   Roll  Q\n    (sec)     (m)  (Deg)\n 1 2 3 1\n 4 5 6 1\n"),
            (Units{"sec", "m", "deg", ""}));
  EXPECT_EQ(units("Project: a\n\n  GPSTime  Q   H-Ell   Roll\n    (sec)        (m)  [rad]\n 1 1 2 3\n 4 1 5 6\n"),
            (Units{"sec", "", "m", "rad"}));
  EXPECT_EQ(units("GPSTime,H-Ell,Roll\ns,m,deg\n1,2,3\n4,5,6\n"), (Units{"s", "m", "deg"}));
  EXPECT_EQ(units("GPSTime,H-Ell,Roll\n1,2,3\n4,5,6\n"), Units{});
  EXPECT_EQ(units("a flight here\nGPSTime H-Ell Roll\n1 2 3\n4 5 6\n"), Units{});
}

TEST_F(TableStarts, WordsAboveTheNamesAreNoNames) {
  const DelimitedLayout layout = inspect_delimited(made("Company,Plane,Pilot\ntime,lat,height\n1,2,3\n4,5,6\n7,8,9\n"));
  EXPECT_EQ(layout.names, (std::vector<std::string>{"time", "lat", "height"}));
  EXPECT_EQ(inspect_delimited(made("flight 7\ntime,lat,height\ns,deg,m\n1,2,3\n4,5,6\n7,8,9\n")).names, layout.names) << "units below them";
}

TEST_F(TableStarts, RecordsMayHoldDatesAndWords) {
  const Rows rows{{1, 2, 3}, {4, 5, 6}};
  const std::vector<std::string> named{"GPSTime", "H-Ell", "Roll"};
  const std::string head = "Project:  flight\nProgram:  IE Version 8.90\n\n";
  EXPECT_EQ(read_all(made(head + "Date GPSTime H-Ell Roll\n(MDY) (sec) (m) (deg)\n6/12/2020 1 2 3\n6/12/2020 4 5 6\n"), named), rows);
  EXPECT_EQ(read_all(made(head + "GPSTime H-Ell AmbStatus Roll\n(sec) (m) (deg)\n1 2 Fixed 3\n4 5 Float 6\n"), named), rows);
}

TEST_F(TableStarts, RecordsOfOtherFormsAboveAreNotLost) {
  std::string rows;
  for (int k = 0; k < 40; ++k)
    rows += std::to_string(474006 + k) + ",47.1,10.5,600," + (k < 20 ? (k % 2 == 0 ? "Fixed" : "") : "Float") + "\n";
  EXPECT_EQ(read_all(made(rows), {"1"}).size(), 40U);
  EXPECT_EQ(read_all(made("# t,lat,lon,h,status\n" + rows), {"t"}).size(), 40U);
  EXPECT_EQ(read_all(made("t,lat,lon,h,status\n" + rows), {"t"}).size(), 40U);
  EXPECT_EQ(read_all(made("1,474006,47.1,10.5,first\n2,474007,47.1,10.5,\n3,474008,47.1,10.5,turn\n4,474009,47.1,10.5,\n"
                          "5,474010,47.1,10.5,\n6,474011,47.1,10.5,\n"),
                     {"1"})
                .size(),
            6U);
}

TEST_F(TableStarts, ADescriptionMayHoldDatesAndPlaces) {
  const Rows rows{{1}, {4}};
  const std::string table = "time lat lon h\n1 47.1 10.5 600\n4 47.1 10.5 600\n";
  EXPECT_EQ(read_all(made("Project: x\nStations of the base:\n1 BASE1 47.1 10.5 600.0\n2 BASE2 47.2 10.6 610.0\n" + table), {"time"}),
            rows);
  EXPECT_EQ(read_all(made("2020-06-12 10:00:01 2.5 start of log\n2020-06-12 10:00:02 3.5 file opened ok\n" + table), {"time"}), rows);
  EXPECT_EQ(read_all(made("2020-06-12 19:34:18\ntime range\n1 2\n4 4\n"), {"time"}), rows);
}

TEST_F(TableStarts, UnitsAreWordsOrBareBetweenBrackets) {
  const Rows rows{{1}, {4}};
  EXPECT_EQ(read_all(made("Week D GPSTime H-Ell\n(weeks) d (sec) (m)\n2317 5 1 2\n2317 5 4 5\n"), {"GPSTime"}), rows);
  EXPECT_EQ(read_all(made("time,lat,lon,height\nseconds,degrees,degrees,meters\n1,2,3,4\n4,6,7,8\n"), {"time"}), rows);
}

TEST_F(TableStarts, NamesMayBeInACommentBelowADescription) {
  EXPECT_EQ(read_all(made("made by a logger\non a day in June\n# time lat h\n1 2 3\n4 5 6\n"), {"lat"}), (Rows{{2}, {5}}));
}

TEST_F(TableStarts, ALastDelimiterEndsNoColumn) {
  const DelimitedLayout ended = inspect_delimited(made("t\ta\tr\t\n1\t2\t3\t\n4\t5\t6\t\n"));
  EXPECT_EQ(ended.names, (std::vector<std::string>{"t", "a", "r"}));
  EXPECT_EQ(ended.columns, 3U);
  EXPECT_EQ(inspect_delimited(made("t,a,r\n1,2,3,\n4,5,6,\n")).columns, 3U);
  EXPECT_EQ(read_all(made("t,a,r\n1,2,3,\n4,5,6,\n"), {"r"}), (Rows{{3}, {6}}));
}

TEST_F(TableStarts, ARowPartedByBlanksThatLacksAFieldIsRefused) {
  const core::Error e = error_of("t lat h roll\n1 47 611 0.5\n2 47 0.5\n", {"h"});
  EXPECT_NE(e.where().find(":3"), std::string::npos) << e.text();
  EXPECT_NE(e.text().find("the line has 3 fields, the header 4 columns"), std::string::npos) << e.text();
}

TEST_F(TableStarts, TimesOfDayAndMinutesOfArcAreNamed) {
  EXPECT_NE(error_of("t,lat\n19:34:18,1\n", {"t"}).hint().find("times of day"), std::string::npos);
  EXPECT_NE(error_of("t,lat\n1,47 54 23.1\n", {"t", "lat"}).hint().find("decimal degrees"), std::string::npos);
}

TEST_F(TableStarts, ADamagedFirstRecordIsNoDescription) {
  const std::string rest = "1,2,3\n4,5,6\n7,8,9\n";
  for (const std::string& text : {rest, "a,b,c\n" + rest, "a,b,c\nx,2,3\n" + rest, "1,,3\n2,,4\n" + rest, std::string("P1,2,3\nP2,5,6\n")})
    EXPECT_EQ(table_start(made(text)).data, 0u) << text;
  EXPECT_NE(error_of("a,b,c\nx,2,3\n" + rest, {"a"}).where().find(":2"), std::string::npos);
  EXPECT_EQ(inspect_delimited(made("a,b,c\nx,2\n" + rest)).cut_line, 2u);
  EXPECT_EQ(inspect_delimited(made("a,b,c\nbroken\n" + rest)).cut_line, 2u);
  EXPECT_NE(error_of("logger 1\nof June\na,b,c\nx,2,3\n" + rest, {"a"}).where().find(":4"), std::string::npos);
  // Records with empty fields are records, with a description above them or not.
  EXPECT_EQ(read_all(made("a,b,c\n1,,3\n2,,4\n" + rest), {"a", "c"}).size(), 5u);
  EXPECT_EQ(read_all(made("logger\nof June\na,b,c\n1,,3\n2,,4\n" + rest), {"a", "c"}).size(), 5u);
  EXPECT_EQ(read_all(made("1,,3\n2,,4\n" + rest), {"1", "3"}).size(), 5u);
}

}  // namespace
}  // namespace swath::io
