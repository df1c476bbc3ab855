// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/checksum.h"

#include <fcntl.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <vector>

#include "core/config/option_visitors.h"
#include "io/store/address.h"
#include "io/store/input_file.h"
#include "io/store/object.h"
#include "io/text/output_file.h"

namespace swath::pipeline {

struct Checksum::State {
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> xxh{XXH3_createState(), &XXH3_freeState};
};

Checksum::Checksum() : state_(std::make_unique<State>()) { XXH3_64bits_reset(state_->xxh.get()); }
Checksum::~Checksum() = default;
Checksum::Checksum(Checksum&&) noexcept = default;
Checksum& Checksum::operator=(Checksum&&) noexcept = default;

void Checksum::add(const void* data, std::size_t n) { XXH3_64bits_update(state_->xxh.get(), data, n); }
std::string Checksum::text() const { return core::hex(XXH3_64bits_digest(state_->xxh.get())); }

std::string checksum_of(std::string_view bytes) { return core::hex(XXH3_64bits(bytes.data(), bytes.size())); }

std::string checksum_of_file(const std::filesystem::path& file) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe without a writer would keep us waiting
  if (fd < 0) io::throw_system_error("cannot open", file, errno);
  Checksum sum;
  std::vector<char> buffer(std::size_t{1} << 20);
  for (;;) {
    const ssize_t n = ::read(fd, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    const int code = n < 0 ? errno : 0;
    if (n <= 0) ::close(fd);
    if (code) io::throw_system_error("cannot read", file, code);
    if (n == 0) return sum.text();
    sum.add(buffer.data(), static_cast<std::size_t>(n));
  }
}

std::string checksum_of_input(const std::filesystem::path& file) {
  if (!io::is_address(file)) return checksum_of_file(file);
  const io::ObjectState state = io::object_state(file);
  if (!state.version.empty()) return checksum_of(state.version + std::to_string(state.bytes));
  io::InputFile object(file);
  Checksum sum;
  std::vector<char> buffer(std::size_t{1} << 20);
  for (std::uint64_t at = 0; at < object.size();) {
    const std::size_t n = object.read_some(at, buffer.data(), buffer.size());
    sum.add(buffer.data(), n);
    at += n;
  }
  return sum.text();
}

}  // namespace swath::pipeline
