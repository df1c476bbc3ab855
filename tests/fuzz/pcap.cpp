// SPDX-License-Identifier: GPL-3.0-or-later
// Captured network packets, pcap and pcapng.
#include "io/records/describe_pcap.h"

#include "io/survey/info.h"
#include "tests/fuzz/target.h"

using namespace swath;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::given("packets.pcap", data, size);
  fuzz::reading([&] { io::info_text(io::describe_pcap(file)); });
  return 0;
}
