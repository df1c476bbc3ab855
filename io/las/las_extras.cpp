// SPDX-License-Identifier: GPL-3.0-or-later
// Source: ASPRS LAS Specification 1.4 R15 (2019), 2.7.6.
// Deviation: fields keep the deprecated two- and three-component types readable.
#include "io/las/las_extras.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "io/las/las_bytes.h"

namespace swath::io {

using las::get;
using las::put;
using las::put_text;
using las::text_of;

namespace {

constexpr std::size_t extra_record = 192;

std::vector<LasExtra> parse_extras(const std::vector<std::uint8_t>& data) {
  std::vector<LasExtra> out;
  for (std::size_t at = 0; at + extra_record <= data.size(); at += extra_record) {
    const std::uint8_t* b = data.data() + at;
    LasExtra e;
    e.as_read.assign(b, b + extra_record);
    e.type = b[2];
    e.name = text_of(b + 4, 32);
    e.description = text_of(b + 160, 32);
    if (e.type == 0) {
      e.bytes = b[3];
    } else {
      const auto three = [b]<class T>(int where, T) {
        return std::array<T, 3>{get<T>(b + where), get<T>(b + where + 8), get<T>(b + where + 16)};
      };
      const std::uint8_t options = b[3];
      if (options & 1) e.nodata = three(40, std::uint64_t{});
      if (options & 2) e.min = three(64, std::uint64_t{});
      if (options & 4) e.max = three(88, std::uint64_t{});
      if (options & 8) e.scale = three(112, 0.0);
      if (options & 16) e.offset = three(136, 0.0);
    }
    out.push_back(std::move(e));
  }
  return out;
}

bool describes_extras(const LasVlr& v) { return v.user_id == "LASF_Spec" && v.record_id == 4; }

bool is_described(const LasExtra& e) { return e.type != 0 || !e.name.empty() || !e.as_read.empty(); }

/// Up to the last field that has a description.
std::vector<std::uint8_t> extras_bytes(const std::vector<LasExtra>& extras) {
  std::size_t n = extras.size();
  while (n > 0 && !is_described(extras[n - 1])) --n;
  std::vector<std::uint8_t> out(n * extra_record);
  for (std::size_t i = 0; i < n; ++i) {
    std::uint8_t* b = out.data() + i * extra_record;
    const LasExtra& e = extras[i];
    if (!e.as_read.empty()) {
      std::copy(e.as_read.begin(), e.as_read.end(), b);
      continue;
    }
    b[2] = e.type;
    b[3] =
        e.type == 0
            ? e.bytes
            : static_cast<std::uint8_t>((e.nodata ? 1 : 0) | (e.min ? 2 : 0) | (e.max ? 4 : 0) | (e.scale ? 8 : 0) | (e.offset ? 16 : 0));
    put_text(b + 4, 32, e.name);
    put_text(b + 160, 32, e.description);
    const auto three = [b](int where, const auto& values) {
      if (values)
        for (int k = 0; k < 3; ++k) put(b + where + 8 * k, (*values)[static_cast<std::size_t>(k)]);
    };
    three(40, e.nodata), three(64, e.min), three(88, e.max), three(112, e.scale), three(136, e.offset);
  }
  return out;
}

}  // namespace

int LasExtra::size() const {
  constexpr std::array<int, 11> of_type{0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  if (type == 0) return bytes;
  return components() * of_type[static_cast<std::size_t>((type - 1) % 10 + 1)];
}

std::vector<LasVlr> with_extras(const std::vector<LasVlr>& vlrs, const std::vector<LasExtra>& extras) {
  std::vector<std::uint8_t> said, all = extras_bytes(extras);
  for (const LasVlr& v : vlrs)
    if (describes_extras(v)) said.insert(said.end(), v.data.begin(), v.data.end());
  if (said == all) return vlrs;
  std::vector<LasVlr> out;
  for (const LasVlr& v : vlrs) {
    if (describes_extras(v) && all.empty()) continue;
    out.push_back(v);
    if (describes_extras(v)) out.back().data = std::exchange(all, {});
  }
  if (!all.empty()) out.push_back({"LASF_Spec", 4, "Extra bytes", std::move(all), 0, 0});
  return out;
}

std::vector<LasExtra> extras_of(const std::vector<LasVlr>& vlrs, const std::vector<LasVlr>& evlrs, int bytes,
                                std::vector<std::string>& warnings) {
  std::vector<LasExtra> out;
  for (const auto* list : {&vlrs, &evlrs})
    for (const LasVlr& v : *list)
      if (describes_extras(v)) std::ranges::move(parse_extras(v.data), std::back_inserter(out));
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out[i].type > 30) {
      warnings.push_back("extra bytes field '" + out[i].name + "' has the unknown type " + std::to_string(out[i].type) +
                         "; it and all after it are kept as raw bytes");
      out.resize(i);
    } else if (out[i].size() > bytes) {
      warnings.push_back("extra bytes field '" + out[i].name + "' is described but not in the records");
      out.resize(i);
    } else {
      bytes -= out[i].size();
    }
  }
  while (bytes > 0) {
    LasExtra raw;
    raw.type = 0;
    raw.bytes = static_cast<std::uint8_t>(std::min(bytes, 255));
    bytes -= raw.bytes;
    out.push_back(raw);
  }
  return out;
}

}  // namespace swath::io
