// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/describe_pcap.h"

#include "io/survey/info.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

void put(std::string& to, std::uint64_t v, int bytes, bool big = false) {
  for (int k = 0; k < bytes; ++k) to.push_back(static_cast<char>(v >> (8 * (big ? bytes - 1 - k : k))));
}

/// Ethernet, IPv4 and UDP around a payload of so many bytes.
std::string frame(int port, size_t payload) {
  std::string p(12, '\0');
  put(p, 0x0800, 2, true);
  p += '\x45';
  p.resize(14 + 9, '\0');
  p += '\x11';
  p.resize(14 + 20, '\0');
  put(p, 1, 2, true), put(p, static_cast<std::uint64_t>(port), 2, true), put(p, payload + 8, 2, true), put(p, 0, 2);
  return p + std::string(payload, 'd');
}

std::string capture(bool big, const std::vector<std::string>& frames) {
  std::string out;
  put(out, 0xa1b2c3d4, 4, big), put(out, 2, 2, big), put(out, 4, 2, big), put(out, 0, 8, big), put(out, 65535, 4, big), put(out, 1, 4, big);
  std::uint64_t second = 1700000000;
  for (const std::string& f : frames) {
    put(out, second++, 4, big), put(out, 500000, 4, big), put(out, f.size(), 4, big), put(out, f.size(), 4, big);
    out += f;
  }
  return out;
}

TEST(DescribePcap, PacketsTimesAndPorts) {
  const test::TemporaryFolder folder;
  for (const bool big : {false, true}) {
    test::write_bytes(folder / "a.pcap", capture(big, {frame(2368, 1206), frame(2368, 1206), frame(8308, 512)}));
    const core::Value told = describe_file(folder / "a.pcap");
    EXPECT_EQ(told.find("format")->as_text(), "pcap capture");
    EXPECT_EQ(told.find("packets")->as_int(), 3);
    EXPECT_EQ(told.find("seconds")->as_number(), 2.0);
    const auto& udp = told.find("udp")->items();
    ASSERT_EQ(udp.size(), 2u);
    EXPECT_EQ(udp[0].find("port")->as_int(), 2368);
    EXPECT_EQ(udp[0].find("payload_bytes")->as_int(), 1206);
    EXPECT_EQ(udp[0].find("packets")->as_int(), 2);
  }
}

TEST(DescribePcap, ACutFileIsToldAndNextGenerationCounted) {
  const test::TemporaryFolder folder;
  std::string bytes = capture(false, {frame(2368, 100), frame(2368, 100)});
  bytes.resize(bytes.size() - 10);
  test::write_bytes(folder / "a.pcap", bytes);
  EXPECT_NE(info_text(describe_pcap(folder / "a.pcap")).find("ends inside the packet"), std::string::npos);

  std::string next;
  put(next, 0x0a0d0d0a, 4), put(next, 28, 4), put(next, 0x1a2b3c4d, 4), put(next, 1, 4), put(next, ~0ull, 8), put(next, 28, 4);
  std::string f = frame(2368, 102);
  put(next, 6, 4), put(next, 32 + f.size(), 4), put(next, 0, 8), put(next, 0, 4), put(next, f.size(), 4), put(next, f.size(), 4);
  next += f;
  put(next, 32 + f.size(), 4);
  ASSERT_EQ(f.size() % 4, 0u);
  test::write_bytes(folder / "a.pcapng", next);
  const core::Value told = describe_file(folder / "a.pcapng");
  EXPECT_EQ(told.find("packets")->as_int(), 1);
  EXPECT_EQ(told.find("udp")->items()[0].find("port")->as_int(), 2368);
}

}  // namespace
}  // namespace swath::io
