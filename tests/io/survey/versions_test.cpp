// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/versions.h"

#include <gtest/gtest.h>

TEST(Versions, NamesWhatIsLinked) {
  const swath::core::Value v = swath::io::library_versions();
  for (const char* library : {"GDAL", "PROJ"}) {
    ASSERT_NE(v.find(library), nullptr);
    EXPECT_NE(v.find(library)->as_text().find('.'), std::string::npos);
  }
}
