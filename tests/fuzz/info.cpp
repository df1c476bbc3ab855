// SPDX-License-Identifier: GPL-3.0-or-later
// `swath info`: the kind of any file from its content, packet captures and what no other target reads among them.
#include "io/survey/info.h"

#include "tests/fuzz/target.h"

using namespace swath;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::given("any", data, size);
  fuzz::reading([&] { io::info_text(io::describe_file(file)); });
  return 0;
}
