// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/vector_sink.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>

namespace swath::io {
namespace {

constexpr size_t buffer_size = 1u << 18;

void write_at(int fd, std::uint64_t byte, std::string_view text, const std::filesystem::path& file) {
  for (size_t done = 0; done < text.size();) {
    const ssize_t n = ::pwrite(fd, text.data() + done, text.size() - done, static_cast<off_t>(byte + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw_system_error("cannot write", file, errno);
    done += static_cast<size_t>(n);
  }
}

}  // namespace

TextStream::TextStream(const std::filesystem::path& file) : file_(file), out_(file) {
  fd_ = ::open(out_.temporary().c_str(), O_WRONLY | O_CLOEXEC);
  if (fd_ < 0) throw_system_error("cannot write", file_, errno);
}

TextStream::~TextStream() {
  if (fd_ >= 0) ::close(fd_);
}

TextStream& TextStream::operator<<(std::string_view text) {
  buffer_ += text;
  if (buffer_.size() >= buffer_size) flush();
  return *this;
}

TextStream& TextStream::fixed(double value, int decimals) { return *this << fixed_text(value, decimals); }

void TextStream::patch(std::uint64_t byte, std::string_view text) {
  flush();
  write_at(fd_, byte, text, file_);
}

void TextStream::flush() {
  write_at(fd_, flushed_, buffer_, file_);
  flushed_ += buffer_.size();
  buffer_.clear();
}

void TextStream::close() {
  flush();
  const int failed = ::close(fd_) ? errno : 0;
  fd_ = -1;
  if (failed) throw_system_error("cannot finish", file_, failed);
  out_.commit();
}

std::string fixed_text(double value, int decimals) {
  char text[400];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, decimals).ptr;
  std::string out(text, end);
  if (out[0] == '-' && out.find_first_not_of("-0.") == std::string::npos) out.erase(0, 1);
  return out;
}

std::string shortest_text(double value) {
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, value == 0.0 ? 0.0 : value).ptr;
  return std::string(text, end);
}

}  // namespace swath::io
