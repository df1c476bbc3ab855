// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/view/packed.h"

#include <zlib.h>

#include "core/error.h"

namespace swath::tools {
namespace {

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  constexpr int level = 6;
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), level) != Z_OK)
    throw core::SystemError("points cannot be compressed: out of memory", "", "show fewer: --points 500000");
  out.resize(size);
  return out;
}

template <class Unsigned>
std::string planes_of(std::span<const Unsigned> values) {
  std::string out;
  out.reserve(values.size() * sizeof(Unsigned));
  for (std::size_t p = 0; p < sizeof(Unsigned); ++p)
    for (const Unsigned v : values) out += static_cast<char>(static_cast<unsigned char>(v >> (8 * p)));
  return out;
}

}  // namespace

void Packer::put(const std::string& name, const char* type, bool delta, std::size_t count, const std::string& planes) {
  core::Value& about = table[name];
  about["blob"] = prefix_ + "." + name;
  about["type"] = type;
  about["delta"] = delta;
  about["count"] = static_cast<std::uint64_t>(count);
  blobs.push_back({prefix_ + "." + name, deflated(planes)});
}

void Packer::add(const std::string& name, std::span<const std::uint8_t> values) {
  put(name, "u8", false, values.size(), planes_of(values));
}

void Packer::add(const std::string& name, std::span<const std::uint16_t> values) {
  put(name, "u16", false, values.size(), planes_of(values));
}

void Packer::add(const std::string& name, std::span<const std::int32_t> values) {
  std::vector<std::uint32_t> steps;
  steps.reserve(values.size());
  std::uint32_t before = 0;
  for (const std::int32_t v : values) {
    const auto now = static_cast<std::uint32_t>(v), step = now - before;
    steps.push_back((step << 1) ^ (step >> 31 ? ~0u : 0u));
    before = now;
  }
  put(name, "i32", true, values.size(), planes_of(std::span<const std::uint32_t>(steps)));
}

}  // namespace swath::tools
