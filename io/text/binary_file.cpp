// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/binary_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "core/error.h"
#include "io/text/output_file.h"

namespace swath::io {

std::string hint_of_folder(const std::filesystem::path& folder) {
  std::error_code unknown;
  const std::filesystem::path survey = folder / "survey.toml";
  if (std::filesystem::exists(survey, unknown)) return "name its survey: " + survey.string();
  return "name one of its files; `swath init FOLDER` proposes a survey.toml of the records in a folder";
}

BinaryFile::BinaryFile(std::filesystem::path file) : path_(std::move(file)) {
  fd_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe without a writer would keep us waiting
  if (fd_ < 0) throw_system_error("cannot open", path_, errno);
  struct stat info {};
  const int failed = ::fstat(fd_, &info) ? errno : 0;
  if (failed || !S_ISREG(info.st_mode)) {
    ::close(fd_);
    if (failed) throw_system_error("cannot open", path_, failed);
    if (S_ISDIR(info.st_mode)) throw core::Error("is a folder, not a file", path_.string(), hint_of_folder(path_));
    throw core::Error("is not a regular file", path_.string());
  }
  size_ = static_cast<std::uint64_t>(info.st_size);
}

BinaryFile::~BinaryFile() { ::close(fd_); }

size_t BinaryFile::read_some(std::uint64_t at, void* to, size_t n) const {
  size_t done = 0;
  while (done < n) {
    const ssize_t got = ::pread(fd_, static_cast<char*>(to) + done, n - done, static_cast<off_t>(at + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw_system_error("cannot read", path_, errno);
    if (got == 0) break;
    done += static_cast<size_t>(got);
  }
  return done;
}

void BinaryFile::read(std::uint64_t at, void* to, size_t n) const {
  const size_t got = read_some(at, to, n);
  if (got < n)
    throw core::Error("the file ends early: " + std::to_string(n) + " bytes expected from byte " + std::to_string(at) + ", " +
                          std::to_string(got) + " are there",
                      path_.string() + ": byte " + std::to_string(at + got), "the file is truncated: copy or export it again");
}

BinaryAppender::BinaryAppender(const std::filesystem::path& file, std::filesystem::path named) : named_(std::move(named)) {
  fd_ = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
  if (fd_ < 0) throw_system_error("cannot write", named_, errno);
}

BinaryAppender::~BinaryAppender() {
  if (fd_ >= 0) ::close(fd_);
}

void BinaryAppender::append(const void* from, size_t n) {
  rewrite(size_, from, n);
  size_ += n;
}

void BinaryAppender::rewrite(std::uint64_t at, const void* from, size_t n) {
  for (size_t done = 0; done < n;) {
    const ssize_t put = ::pwrite(fd_, static_cast<const char*>(from) + done, n - done, static_cast<off_t>(at + done));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) throw_system_error("cannot write", named_, errno);
    done += static_cast<size_t>(put);
  }
}

void BinaryAppender::close() {
  const int failed = ::close(fd_) ? errno : 0;
  fd_ = -1;
  if (failed) throw_system_error("cannot write", named_, failed);
}

}  // namespace swath::io
