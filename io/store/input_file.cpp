// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/store/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "core/error.h"
#include "io/store/address.h"
#include "io/store/object.h"
#include "io/text/output_file.h"

namespace swath::io {

InputFile::InputFile(std::filesystem::path file) : path_(std::move(file)) {
  if (is_address(path_)) {
    object_ = std::make_unique<StoredObject>(path_);
    size_ = object_->size();
    return;
  }
  fd_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe without a writer would keep us waiting
  if (fd_ < 0) throw_system_error("cannot read", path_, errno);
  struct stat info {};
  const int failed = ::fstat(fd_, &info) ? errno : S_ISDIR(info.st_mode) ? EISDIR : 0;
  if (failed || !S_ISREG(info.st_mode)) {
    ::close(std::exchange(fd_, -1));
    if (failed) throw_system_error("cannot read", path_, failed);
    throw core::Error("is not a regular file", path_.string());
  }
  size_ = static_cast<std::uint64_t>(info.st_size);
}

InputFile::~InputFile() {
  if (fd_ >= 0) ::close(fd_);
}

InputFile::InputFile(InputFile&& other) noexcept
    : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)), object_(std::move(other.object_)), size_(other.size_) {}

InputFile& InputFile::operator=(InputFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(fd_, other.fd_);
  std::swap(object_, other.object_);
  std::swap(size_, other.size_);
  return *this;
}

std::size_t InputFile::read_some(std::uint64_t at, void* to, std::size_t n) {
  if (object_) return object_->read_some(at, to, n);
  std::size_t done = 0;
  while (done < n) {
    const ssize_t got = ::pread(fd_, static_cast<char*>(to) + done, n - done, static_cast<off_t>(at + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw_system_error("cannot read", path_, errno);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

}  // namespace swath::io
