// SPDX-License-Identifier: GPL-3.0-or-later
// SBET trajectories and their accuracies. The first byte says how many of the others, in eighths, are the SBET; the rest is the smrmsg.
#include "io/records/sbet.h"

#include "io/records/trajectory_file.h"
#include "io/survey/info.h"
#include "tests/fuzz/target.h"

using namespace swath;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t first = (size - 1) * std::min<std::size_t>(data[0], 8) / 8;
  const auto file = fuzz::given("sbet.out", data + 1, first);
  const auto accuracy = fuzz::given("smrmsg.out", data + 1 + first, size - 1 - first);
  static const std::string table = "[[trajectory]]\nfile = \"sbet.out\"\ntime = { scale = \"gps_week\", week = 2317 }\n";
  static const io::Survey with = fuzz::survey_of(table + "accuracy = \"smrmsg.out\"\n"), without = fuzz::survey_of(table);
  for (const io::Survey* survey : {&with, &without})
    fuzz::reading([&] {
      core::Tally tally;
      fuzz::expect_sound(io::read_trajectory(*survey, tally));
    });
  fuzz::reading([&] { io::describe_file(file); });
  fuzz::reading([&] { io::describe_file(accuracy); });
  return 0;
}
