// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/antex.h"

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

std::string record(std::string text, const std::string& label) {
  text.resize(60, ' ');
  return text + label + "\n";
}

std::string antenna(const std::string& type, const std::string& serial = {}) {
  std::string text = type;
  text.resize(20, ' ');
  return record("", "START OF ANTENNA") + record(text + serial, "TYPE / SERIAL NO") + record("", "END OF ANTENNA");
}

TEST(Antex, ListsReceiverAntennasAndFindsThem) {
  const test::TemporaryFolder folder;
  const auto file = folder / "a.atx";
  test::write_bytes(file, record("     1.4            M", "ANTEX VERSION / SYST") + antenna("BLOCK IIA", "G01") +
                              antenna("TRM41249.00     NONE") + antenna("TRM41249.00     TZGD") + antenna("AERAT2775_42    NONE", "1234"));
  const auto types = antex_types(file);
  EXPECT_EQ(types, (std::vector<std::string>{"TRM41249.00     NONE", "TRM41249.00     TZGD", "AERAT2775_42    NONE"}));
  EXPECT_EQ(find_antenna(types, "TRM41249.00 TZGD", file), "TRM41249.00     TZGD");
  EXPECT_EQ(find_antenna(types, "TRM41249.00", file), "TRM41249.00     NONE");
  EXPECT_EQ(find_antenna(types, "TRM41249.00     SCIS", file), "TRM41249.00     NONE") << "a radome that is not described";
  try {
    find_antenna(types, "TRM41294.00     NONE", file);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.text().find("did you mean 'TRM41249.00     NONE'"), std::string::npos) << e.text();
  }
}

TEST(Antex, OtherFilesAreRefused) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.atx", "time,x,y\n");
  EXPECT_THROW(antex_types(folder / "a.atx"), core::Error);
  test::write_bytes(folder / "b.atx", record("     1.4            M", "ANTEX VERSION / SYST") + antenna("BLOCK IIA", "G01"));
  EXPECT_THROW(antex_types(folder / "b.atx"), core::Error);
  EXPECT_THROW(antex_types(folder / "none.atx"), core::Error);
  EXPECT_THROW(antex_types(folder.path()), core::Error);
}

}  // namespace
}  // namespace swath::io
