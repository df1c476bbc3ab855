// SPDX-License-Identifier: GPL-3.0-or-later
// Layouts: libpcap's file format (draft-ietf-opsawg-pcap) and pcapng (draft-ietf-opsawg-pcapng); Ethernet II, IPv4, UDP (RFC 791, 768).
#include "io/records/describe_pcap.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/time.h"
#include "io/text/binary_file.h"

namespace swath::io {
namespace {

using core::Value;

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

class Capture {
 public:
  explicit Capture(const std::filesystem::path& path) : file_(path) {}

  Value describe() {
    std::array<unsigned char, 24> head{};
    file_.read(0, head.data(), head.size());
    const auto magic = load<std::uint32_t>(head.data());
    Value out = Value::object();
    if (magic == next_generation) {
      out["format"] = "pcapng capture";
      blocks(load<std::uint32_t>(&head[8]) != 0x1a2b3c4d);
    } else {
      out["format"] = "pcap capture";
      const bool big = swapped(magic) == micro || swapped(magic) == nano;
      records(big, magic == nano || swapped(magic) == nano ? 1e-9 : 1e-6, load<std::uint32_t>(&head[20], big) == 1);
    }
    out["packets"] = packets_;
    if (first_ <= last_) {
      out["from"] = core::utc_text(core::from_unix(first_));
      out["to"] = core::utc_text(core::from_unix(last_));
      out["seconds"] = last_ - first_;
    }
    Value& list = out["udp"] = Value::array();
    for (const auto& [key, n] : ports_) {
      Value one = Value::object();
      one["port"] = key.first;
      one["payload_bytes"] = key.second;
      one["packets"] = n;
      list.push(std::move(one));
    }
    if (list.items().empty()) warnings_.push("no UDP packet: no lidar's data");
    warnings_.push("packets of a sensor are not read as they are: export its points or ranges with the maker's software");
    out["warnings"] = std::move(warnings_);
    return out;
  }

 private:
  void take(const unsigned char* p, size_t n, bool ethernet) {
    ++packets_;
    if (const auto [port, payload] = udp_of(p, n); ethernet && port != 0) ++ports_[{port, payload}];
  }

  void cut(std::uint64_t at) { warnings_.push("the file ends inside the packet at byte " + std::to_string(at)); }

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
      first_ = std::min(first_, time);
      last_ = std::max(last_, time);
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
  std::uint64_t packets_ = 0;
  double first_ = std::numeric_limits<double>::infinity(), last_ = -std::numeric_limits<double>::infinity();
  std::map<std::pair<int, int>, std::uint64_t> ports_;
  Value warnings_ = Value::array();
};

}  // namespace

bool looks_like_pcap(std::string_view start) {
  if (start.size() < 24) return false;
  const auto magic = load<std::uint32_t>(reinterpret_cast<const unsigned char*>(start.data()));
  return magic == next_generation || magic == micro || magic == nano || swapped(magic) == micro || swapped(magic) == nano;
}

core::Value describe_pcap(const std::filesystem::path& file) { return Capture(file).describe(); }

}  // namespace swath::io
