// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include "core/error.h"

namespace swath::io {

void throw_system_error(std::string_view doing, const std::filesystem::path& file, int code) {
  std::string hint;
  if (code == ENOSPC || code == EDQUOT)
    hint = "the disk is full: free space there, then run the same command again; what is finished is kept";
  if (code == EFBIG)
    hint = "the file size limit is reached: raise it (ulimit -f), then run the same command again; what is finished is kept";
  if (code == EACCES || code == EPERM || code == EROFS) hint = "choose a folder that you may write to";
  if (code == ENOENT) hint = "check the name; names in a survey are relative to its survey.toml";
  throw core::SystemError(std::string(doing) + ": " + (code ? std::strerror(code) : "unknown reason"), file.string(), hint);
}

OutputFile::OutputFile(std::filesystem::path final_name) : final_(std::move(final_name)) {
  static std::atomic<unsigned> serial{0};
  // The ending stays last: libraries choose formats by it.
  temporary_ =
      final_.parent_path() / (".part-" + std::to_string(getpid()) + "-" + std::to_string(serial++) + "-" + final_.filename().string());
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

void OutputFile::commit(bool flush) {
  const int fd = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) throw_system_error("cannot finish", final_, errno);
  const int failed = flush && ::fsync(fd) ? errno : 0;
  ::close(fd);
  if (failed) throw_system_error("cannot finish", final_, failed);
  if (std::rename(temporary_.c_str(), final_.c_str())) throw_system_error("cannot finish", final_, errno);
  committed_ = true;
}

void write_text_file(const std::filesystem::path& file, std::string_view text, bool flush) {
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
  ::close(fd);
  out.commit(flush);
}

}  // namespace swath::io
