// SPDX-License-Identifier: GPL-3.0-or-later
// Logs of a computer's clock.
#include "io/records/clock_log.h"

#include "tests/fuzz/target.h"

using namespace swath;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::given("clock.log", data, size);
  for (const io::ClockFormat format : {io::ClockFormat::loopstats, io::ClockFormat::peerstats, io::ClockFormat::pps})
    fuzz::reading([&] {
      core::Tally tally;
      const core::ClockData clock = io::read_clock_log(file, format, tally);
      fuzz::expect(clock.epoch, 1e11, "the epoch");
      for (std::size_t i = 0; i < clock.size(); ++i) {
        fuzz::expect(clock.time[i], 1e11, "a time");
        fuzz::expect(clock.offset[i], 1e300, "an offset");
      }
    });
  return 0;
}
