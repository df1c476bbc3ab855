// SPDX-License-Identifier: GPL-3.0-or-later
// RINEX observations, other files of GNSS and antenna files.
#include "io/gnss/rinex_header.h"

#include "io/gnss/antex.h"
#include "io/gnss/describe_gnss.h"
#include "tests/fuzz/target.h"

using namespace swath;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::given("rover.obs", data, size);
  fuzz::reading([&] { io::rinex_kind(file); });
  fuzz::reading([&] {
    const io::RinexObservations o = io::scan_rinex(file);
    fuzz::expect(o.first, 1e11, "the first epoch");
    fuzz::expect(o.last, 1e11, "the last epoch");
    fuzz::expect(o.interval, 1e11, "the interval");
    fuzz::expect(o.header.antenna_offset.norm(), 1e300, "the antenna's offset");
    if (o.header.position) fuzz::expect(o.header.position->norm(), 1e8, "the station");
  });
  fuzz::reading([&] { io::describe_rinex(file); });
  fuzz::reading([&] { io::find_antenna(io::antex_types(file), "TRM41249.00     NONE", file); });
  return 0;
}
