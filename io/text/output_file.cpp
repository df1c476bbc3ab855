// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/output_file.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include "core/error.h"

namespace swath::io {
namespace {

thread_local FinishedFiles* innermost = nullptr;
thread_local int unflushed = 0;

}  // namespace

FinishedFiles::FinishedFiles(std::function<void(const std::filesystem::path&)> then) : outer_(innermost), then_(std::move(then)) {
  innermost = this;
}
FinishedFiles::~FinishedFiles() { innermost = outer_; }

UnflushedFiles::UnflushedFiles() { ++unflushed; }
UnflushedFiles::~UnflushedFiles() { --unflushed; }

namespace {

constexpr const char *full_hint = "the disk is full: free space there, then run the same command again; what is finished is kept",
                     *limit_hint =
                         "the file size limit is reached: raise it (ulimit -f), then run the same command again; what is finished is kept";

std::string temporary_start() { return temporary_mark + std::to_string(getpid()) + "-"; }

/// Is a temporary file beside `file` as long as the process may write one? Libraries do not always give the reason.
bool is_at_size_limit(const std::filesystem::path& file) {
  constexpr std::uintmax_t page = 4096;  // bytes; a library may write in whole pages
  struct rlimit limit {};
  if (::getrlimit(RLIMIT_FSIZE, &limit) || limit.rlim_cur == RLIM_INFINITY) return false;
  std::error_code ec;
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  for (auto at = std::filesystem::directory_iterator(folder, ec); !ec && at != std::filesystem::directory_iterator(); at.increment(ec)) {
    if (!at->path().filename().string().starts_with(temporary_start())) continue;
    std::error_code gone;
    const std::uintmax_t bytes = at->file_size(gone);
    if (!gone && bytes + page > limit.rlim_cur) return true;
  }
  return false;
}

}  // namespace

void throw_system_error(std::string_view doing, const std::filesystem::path& file, int code) {
  std::string hint;
  if (code == ENOSPC || code == EDQUOT) hint = full_hint;
  if (code == EFBIG) hint = limit_hint;
  if (code == EACCES || code == EPERM) hint = "check the rights of the file and of its folder";
  if (code == EROFS) hint = "choose a folder that you may write to";
  if (code == ENOENT) hint = "check the name; names in a survey are relative to its survey.toml";
  if (code == ENAMETOOLONG) hint = "choose a folder with a shorter path, or shorter names";
  throw core::SystemError(std::string(doing) + ": " + (code ? std::strerror(code) : "unknown reason"), file.string(), hint);
}

void throw_write_error(const std::string& what, const std::filesystem::path& file) {
  const auto says = [&](int code) {
    return what.find(std::strerror(code)) != std::string::npos || what.find("os error " + std::to_string(code) + ")") != std::string::npos;
  };
  std::error_code ec;
  const auto space = std::filesystem::space(file.has_parent_path() ? file.parent_path() : std::filesystem::path("."), ec);
  constexpr std::uintmax_t nearly_nothing = 1u << 20;  // bytes
  if (says(ENOSPC) || says(EDQUOT) || (!ec && space.available < nearly_nothing)) {
    const std::string reason = says(ENOSPC) || says(EDQUOT) ? "" : std::string(": ") + std::strerror(ENOSPC);
    throw core::SystemError(what + reason, file.string(), full_hint);
  }
  if (says(EFBIG) || is_at_size_limit(file)) throw core::SystemError(what, file.string(), limit_hint);
  throw core::SystemError(what, file.string(), "does the disk work, and is the folder still there? The same command goes on from here");
}

bool is_temporary(const std::filesystem::path& file) { return file.filename().string().starts_with(temporary_mark); }

OutputFile::OutputFile(std::filesystem::path final_name) : final_(std::move(final_name)) {
  static std::atomic<unsigned> serial{0};
  // The ending stays last: libraries choose formats by it.
  temporary_ = final_.parent_path() / (temporary_start() + std::to_string(serial++) + "-" + final_.filename().string());
  if (!final_.parent_path().empty()) {
    std::error_code ec;
    std::filesystem::create_directories(final_.parent_path(), ec);
    if (ec) throw_system_error("cannot make the folder of the output", final_, ec.value());
  }
  const int fd = ::open(temporary_.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0666);
  if (fd < 0) throw_system_error("cannot write", final_, errno);
  ::close(fd);
}

OutputFile::~OutputFile() {
  if (committed_) return;
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void flush_to_disk(const std::filesystem::path& file) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) throw_system_error("cannot finish", file, errno);
  const int failed = ::fsync(fd) ? errno : 0;
  ::close(fd);
  if (failed && failed != EINVAL) throw_system_error("cannot finish", file, failed);  // file systems without it say so
}

void OutputFile::commit() {
  if (unflushed == 0) flush_to_disk(temporary_);
  if (std::rename(temporary_.c_str(), final_.c_str())) throw_system_error("cannot finish", final_, errno);
  committed_ = true;
  if (!innermost) return;
  innermost->files_.push_back(final_);
  if (innermost->then_) innermost->then_(final_);
}

void write_text_file(const std::filesystem::path& file, std::string_view text) {
  OutputFile out(file);
  const int fd = ::open(out.temporary().c_str(), O_WRONLY | O_CLOEXEC);
  if (fd < 0) throw_system_error("cannot write", file, errno);
  for (size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(fd, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      const int code = errno;
      ::close(fd);
      throw_system_error("cannot write", file, code);
    }
    done += static_cast<size_t>(n);
  }
  if (::close(fd) && errno != EINTR) throw_system_error("cannot write", file, errno);  // a network disk may fail only here
  out.commit();
}

}  // namespace swath::io
