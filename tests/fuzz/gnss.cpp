// SPDX-License-Identifier: GPL-3.0-or-later
// Solutions of RTKLIB, NMEA logs and time tags.
#include "io/gnss/gnss_file.h"

#include "io/gnss/describe_gnss.h"
#include "tests/fuzz/target.h"

using namespace swath;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto pos = fuzz::given("fixes.pos", data, size), log = fuzz::given("fixes.nmea", data, size);
  static const io::Survey solutions =
                              fuzz::survey_of("[[gnss]]\nfile = \"fixes.pos\"\nbase = [\"4212318 m\", \"781325 m\", \"4710401 m\"]\n"),
                          sentences = fuzz::survey_of("[[gnss]]\nfile = \"fixes.nmea\"\n"),
                          dated = fuzz::survey_of("[[gnss]]\nfile = \"fixes.nmea\"\ntime = { date = \"2020-03-18\" }\n");
  for (const io::Survey* survey : {&solutions, &sentences, &dated})
    fuzz::reading([&] {
      core::Tally tally;
      fuzz::expect_sound(io::read_gnss(*survey, tally));
    });
  fuzz::reading([&] { io::describe_pos(pos); });
  fuzz::reading([&] { io::describe_nmea(log); });
  fuzz::reading([&] { io::describe_tag(log); });
  return 0;
}
