// SPDX-License-Identifier: GPL-3.0-or-later
// Objects in the memory of the process, which GDAL reads by the functions that it reads stores by.
#pragma once

#include <cpl_vsi.h>

#include <filesystem>
#include <string>

#include "tests/world/support.h"

namespace swath::test {

/// /vsimem/NAME as long as it lives.
class MemoryObject {
 public:
  MemoryObject(const std::string& name, std::string bytes) : name_("/vsimem/" + name), bytes_(std::move(bytes)) {
    VSIFCloseL(VSIFileFromMemBuffer(name_.c_str(), reinterpret_cast<GByte*>(bytes_.data()), bytes_.size(), FALSE));
  }
  ~MemoryObject() { VSIUnlink(name_.c_str()); }
  MemoryObject(const MemoryObject&) = delete;
  MemoryObject& operator=(const MemoryObject&) = delete;
  std::filesystem::path address() const { return name_; }

 private:
  std::string name_, bytes_;
};

}  // namespace swath::test
