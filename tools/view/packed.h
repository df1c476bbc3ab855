// SPDX-License-Identifier: GPL-3.0-or-later
// Columns of whole numbers as the page unpacks them: planes of bytes, lowest first, deflated (zlib, RFC 1950).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/config/value.h"

namespace swath::tools {

/// A column under the name by which the page asks for it.
struct Blob {
  std::string name;
  std::string bytes;
};

/// A table of the scene that names columns, and the columns.
class Packer {
 public:
  explicit Packer(std::string prefix) : prefix_(std::move(prefix)) {}
  void add(const std::string& name, std::span<const std::uint8_t> values);
  void add(const std::string& name, std::span<const std::uint16_t> values);
  /// As differences from the value before, in zigzag order: neighbours that are alike cost little.
  void add(const std::string& name, std::span<const std::int32_t> values);

  /// {"x": {"blob": "points.x", "type": "i32", "delta": true, "count": n}, ...}
  core::Value table = core::Value::object();
  std::vector<Blob> blobs;

 private:
  void put(const std::string& name, const char* type, bool delta, std::size_t count, const std::string& planes);
  std::string prefix_;
};

}  // namespace swath::tools
