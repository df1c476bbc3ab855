// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <utility>

#include "core/error.h"
#include "io/text/output_file.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;

bool may_run(const fs::path& file) {
  std::error_code ec;
  return fs::is_regular_file(file, ec) && ::access(file.c_str(), X_OK) == 0;
}

constexpr auto poll_step = std::chrono::milliseconds(20);

/// What the child does between fork and exec, where only system calls are allowed: its errors go to `report`.
struct Start {
  const char* program;
  const char* folder;
  const char* log;
  char* const* argv;
  pid_t parent;
  int report;  ///< closed by a successful exec
};

[[noreturn]] void become(const Start& s) {
  // The child starts with no signal blocked or ignored, whatever this program does with them, and does not outlive it.
  sigset_t none;
  sigemptyset(&none);
  for (int signal = 1; signal < NSIG; ++signal) ::signal(signal, SIG_DFL);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::setpgid(0, 0);
  if (::getppid() != s.parent) ::_exit(127);
  const int in = ::open("/dev/null", O_RDONLY | O_CLOEXEC), out = ::open(s.log, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (in >= 0 && out >= 0 && ::dup2(in, 0) >= 0 && ::dup2(out, 1) >= 0 && ::dup2(out, 2) >= 0 && ::chdir(s.folder) == 0)
    ::execv(s.program, s.argv);
  const int failed = errno;
  static_cast<void>(!::write(s.report, &failed, sizeof failed));
  ::_exit(127);
}

/// Waits for the child's end, and ends its group where it takes longer than `limit` (s; 0: no limit).
ProcessEnd wait_for(pid_t child, const fs::path& program, double limit) {
  const auto start = std::chrono::steady_clock::now();
  int status = 0;
  while (true) {
    const pid_t ended = ::waitpid(child, &status, limit > 0 ? WNOHANG : 0);
    if (ended == child) return WIFSIGNALED(status) ? ProcessEnd{-1, WTERMSIG(status)} : ProcessEnd{WEXITSTATUS(status), 0};
    if (ended < 0 && errno != EINTR) throw_system_error("cannot wait for the program", program, errno);
    if (ended != 0) continue;
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > limit) {
      ::kill(-child, SIGKILL);
      while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
      return {-1, SIGKILL, true};
    }
    std::this_thread::sleep_for(poll_step);
  }
}

}  // namespace

fs::path find_program(const fs::path& program) {
  if (program.empty()) return {};
  if (program.has_parent_path()) return may_run(program) ? fs::absolute(program) : fs::path{};
  const char* path = std::getenv("PATH");
  std::string folders = path ? path : "/usr/local/bin:/usr/bin:/bin";
  for (size_t at = 0; at <= folders.size();) {
    const size_t end = std::min(folders.find(':', at), folders.size());
    const fs::path file = fs::path(end > at ? folders.substr(at, end - at) : ".") / program;
    if (may_run(file)) return fs::absolute(file);
    at = end + 1;
  }
  return {};
}

std::string ProcessEnd::text() const {
  if (too_long) return "its time limit";
  if (signal) return "signal " + std::to_string(signal) + " (" + ::strsignal(signal) + ")";
  return "exit code " + std::to_string(code);
}

ProcessEnd run_program(const fs::path& program, const std::vector<std::string>& arguments, const fs::path& folder, const fs::path& log,
                       double limit) {
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);

  const std::string program_name = program.string(), log_name = fs::absolute(log).string(), folder_name = folder.string();
  int report[2] = {-1, -1};
  if (::pipe2(report, O_CLOEXEC) != 0) throw_system_error("cannot start the program", program, errno);
  if (const int above = ::fcntl(report[1], F_DUPFD_CLOEXEC, 3); above >= 0) ::close(std::exchange(report[1], above));  // not 0 to 2
  const Start start{program_name.c_str(), folder_name.c_str(), log_name.c_str(), argv.data(), ::getpid(), report[1]};
  const pid_t child = ::fork();
  if (child == 0) become(start);
  const int not_forked = errno;
  ::close(report[1]);
  int failed = child < 0 ? not_forked : 0;
  if (child > 0) {
    ssize_t got = 0;
    while ((got = ::read(report[0], &failed, sizeof failed)) < 0 && errno == EINTR) continue;
    if (got != sizeof failed) failed = 0;
  }
  ::close(report[0]);
  if (failed) {
    if (child > 0) ::waitpid(child, nullptr, 0);
    throw_system_error("cannot start the program", program, failed);
  }
  return wait_for(child, program, limit);
}

}  // namespace swath::io
