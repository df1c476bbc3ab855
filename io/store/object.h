// SPDX-License-Identifier: GPL-3.0-or-later
// Objects of stores through GDAL's virtual file systems; credentials and endpoints are those of GDAL's own configuration (AWS_* and
// others). Requests are bounded in time: 10 s for a connection, 30 s without data, three further attempts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace swath::io {

/// Lets GDAL open this one address, and no other, on this thread as long as the object lives: names within files stay closed. Not nested.
class OpenAddress {
 public:
  explicit OpenAddress(const std::filesystem::path& address);
  ~OpenAddress();
  OpenAddress(const OpenAddress&) = delete;
  OpenAddress& operator=(const OpenAddress&) = delete;
};

/// An object read by ranges. One object is for one thread at a time.
class StoredObject {
 public:
  /// Throws core::Error that names the address and what to do: no such object, bucket or server, no access.
  explicit StoredObject(std::filesystem::path address);
  ~StoredObject();
  StoredObject(const StoredObject&) = delete;
  StoredObject& operator=(const StoredObject&) = delete;

  std::uint64_t size() const { return size_; }
  /// Up to n bytes from byte `at`: the number that the object still has. Throws core::Error where the store does not give them.
  std::size_t read_some(std::uint64_t at, void* to, std::size_t n);

 private:
  std::filesystem::path address_;
  void* file_ = nullptr;
  std::uint64_t size_ = 0;
};

/// What the store says of an object: it changes where the object does.
struct ObjectState {
  std::uint64_t bytes = 0;
  std::string version;  ///< ETag and time of the last change; empty where the store states neither
};
/// Throws core::Error as StoredObject.
ObjectState object_state(const std::filesystem::path& address);

/// Copies the local file whole to the address and holds the object's size against the file's, which it returns. Throws core::SystemError
/// with the address, the reason and `hint`.
std::uint64_t store_file(const std::filesystem::path& file, const std::filesystem::path& address, const std::string& hint);

}  // namespace swath::io
