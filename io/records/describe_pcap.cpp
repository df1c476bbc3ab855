// SPDX-License-Identifier: GPL-3.0-or-later
// Layouts: libpcap's file format (draft-ietf-opsawg-pcap) and pcapng (draft-ietf-opsawg-pcapng); Ethernet II, IPv4, UDP (RFC 791, 768).
#include "io/records/describe_pcap.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/config/interval.h"
#include "core/config/result_visitors.h"
#include "core/error.h"
#include "core/time.h"
#include "io/text/binary_file.h"

namespace swath::io {
namespace {

constexpr std::uint32_t micro = 0xa1b2c3d4, nano = 0xa1b23c4d, next_generation = 0x0a0d0d0a;
constexpr std::uint32_t longest_packet = 1u << 18;  // bytes, libpcap's own limit

std::uint32_t swapped(std::uint32_t v) { return v >> 24 | (v >> 8 & 0xff00) | (v << 8 & 0xff0000) | v << 24; }

/// Port and payload of a UDP packet in an Ethernet frame; port 0 for others.
std::pair<int, int> udp_of(const unsigned char* p, size_t n) {
  size_t at = 12;
  if (n < 34) return {0, 0};
  while (at + 4 < n && p[at] == 0x81 && p[at + 1] == 0x00) at += 4;  // VLAN tags
  if (at + 22 > n || p[at] != 0x08 || p[at + 1] != 0x00) return {0, 0};
  const size_t ip = at + 2, header = 4u * (p[ip] & 0x0f);
  if (ip + 20 > n || p[ip] >> 4 != 4 || p[ip + 9] != 17 || ip + header + 8 > n) return {0, 0};
  const unsigned char* udp = p + ip + header;
  return {load<std::uint16_t>(udp + 2, true), load<std::uint16_t>(udp + 4, true) - 8};
}

struct PortFacts {
  int port = 0, payload = 0;
  std::uint64_t packets = 0;
};
template <class V>
void describe(const PortFacts& r, V& v) {
  v.result("port", r.port, "Port that they are sent to.");
  v.result("payload_bytes", r.payload, "Bytes of each.");
  v.result("packets", r.packets, "How many there are.");
}

struct CaptureFacts {
  std::string format;
  std::uint64_t packets = 0;
  core::Interval time{};  ///< Unix, s
  std::vector<PortFacts> udp{};
  std::vector<std::string> warnings{};
};
template <class V>
void describe(const CaptureFacts& r, V& v) {
  const auto timed = [&r](core::Form f = {}) { return f.only_if(r.time.any()); };
  const auto utc = [&r](double t) { return r.time.any() ? core::utc_text(core::from_unix(t)) : std::string(); };
  v.result("format", r.format, "Format.");
  v.result("packets", r.packets, "Packets.");
  v.result("from", utc(r.time.low), timed(), "UTC of the first.");
  v.result("to", utc(r.time.high), timed(), "UTC of the last.");
  v.result("seconds", r.time.high - r.time.low, timed(core::seconds()), "Time from the first to the last.");
  v.tables("udp", r.udp, "UDP packets by port and length.");
  v.result("warnings", r.warnings, "What looks wrong.");
}

class Capture {
 public:
  explicit Capture(const std::filesystem::path& path) : file_(path) {}

  CaptureFacts facts() {
    std::array<unsigned char, 24> head{};
    file_.read(0, head.data(), head.size());
    const auto magic = load<std::uint32_t>(head.data());
    if (magic == next_generation) {
      out_.format = "pcapng capture";
      blocks(load<std::uint32_t>(&head[8]) != 0x1a2b3c4d);
    } else {
      out_.format = "pcap capture";
      const bool big = swapped(magic) == micro || swapped(magic) == nano;
      records(big, magic == nano || swapped(magic) == nano ? 1e-9 : 1e-6, load<std::uint32_t>(&head[20], big) == 1);
    }
    for (const auto& [key, n] : ports_) out_.udp.push_back({key.first, key.second, n});
    if (out_.udp.empty()) out_.warnings.push_back("no UDP packet: no lidar's data");
    out_.warnings.push_back("packets of a sensor are not read as they are: export its points or ranges with the maker's software");
    return std::move(out_);
  }

 private:
  void take(const unsigned char* p, size_t n, bool ethernet) {
    ++out_.packets;
    if (const auto [port, payload] = udp_of(p, n); ethernet && port != 0) ++ports_[{port, payload}];
  }

  void cut(std::uint64_t at) { out_.warnings.push_back("the file ends inside the packet at byte " + std::to_string(at)); }

  void records(bool big, double unit, bool ethernet) {
    std::array<unsigned char, 16> head{};
    std::vector<unsigned char> packet;
    for (std::uint64_t at = 24; at < file_.size();) {
      if (file_.read_some(at, head.data(), head.size()) < head.size()) return cut(at);
      const double time = load<std::uint32_t>(head.data(), big) + unit * load<std::uint32_t>(&head[4], big);
      const auto n = load<std::uint32_t>(&head[8], big);
      if (n > longest_packet || at + 16 + n > file_.size()) return cut(at);
      packet.resize(n);
      file_.read(at + 16, packet.data(), n);
      out_.time.add(time);
      take(packet.data(), n, ethernet);
      at += 16 + n;
    }
  }

  void blocks(bool big) {
    constexpr std::uint32_t enhanced = 6;
    std::array<unsigned char, 28> head{};
    std::vector<unsigned char> packet;
    for (std::uint64_t at = 0; at < file_.size();) {
      const size_t got = file_.read_some(at, head.data(), head.size());
      const std::uint32_t length = got >= 12 ? load<std::uint32_t>(&head[4], big) : 0;
      if (length < 12 || length % 4 != 0 || at + length > file_.size()) return cut(at);
      if (load<std::uint32_t>(head.data(), big) == enhanced && got == head.size()) {
        if (length < 32) return cut(at);
        const auto n = std::min({load<std::uint32_t>(&head[20], big), length - 32, longest_packet});
        packet.resize(n);
        file_.read(at + 28, packet.data(), n);
        take(packet.data(), n, true);
      }
      at += length;
    }
  }

  BinaryFile file_;
  CaptureFacts out_;
  std::map<std::pair<int, int>, std::uint64_t> ports_;
};

}  // namespace

bool looks_like_pcap(std::string_view start) {
  if (start.size() < 24) return false;
  const auto magic = load<std::uint32_t>(reinterpret_cast<const unsigned char*>(start.data()));
  return magic == next_generation || magic == micro || magic == nano || swapped(magic) == micro || swapped(magic) == nano;
}

core::Value describe_pcap(const std::filesystem::path& file) { return core::reported(Capture(file).facts()); }

}  // namespace swath::io
