// SPDX-License-Identifier: GPL-3.0-or-later
// Events of u-blox, NovAtel, DJI and RINEX.
#include "io/records/describe_events.h"
#include "io/records/event_marks.h"
#include "tests/fuzz/target.h"

using namespace swath;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::given("events", data, size);
  for (const io::EventFormat format : {io::EventFormat::ubx, io::EventFormat::novatel, io::EventFormat::mrk, io::EventFormat::rinex})
    fuzz::reading([&] {
      core::Tally tally;
      for (const io::EventMark& m : io::read_marks(file, {}, format, tally)) {
        fuzz::expect(m.second, 1e11, "a time");
        fuzz::expect(m.fraction, 2.0, "a fraction");
      }
    });
  fuzz::reading([&] { io::event_format(file); });
  fuzz::reading([&] { io::describe_events(file, io::EventFormat::ubx); });
  fuzz::reading([&] { io::looks_like_loopstats(file); });
  return 0;
}
