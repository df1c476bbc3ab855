// SPDX-License-Identifier: GPL-3.0-or-later
// The folder of the work in progress, OUTPUT/.swath: that it is ours, that one run alone is at work in it, and that what it holds of an
// earlier run is whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>

namespace swath::pipeline {

constexpr const char* released_name = "released.done";  ///< beside the strips, see pipeline/work/released_points.h

/// Throws core::Error (usage) where it is a link or not a folder, or holds anything that no run makes: it would be emptied.
void expect_own(const std::filesystem::path& folder);

/// One run at a time in one output folder; the processes that do one run together hold it together.
class WorkLock {
 public:
  enum class Use { alone, alone_when_free, together };
  /// `work`: the folder. Throws core::Error (usage) where another run is at work in it; `alone_when_free` waits for it to end.
  explicit WorkLock(const std::filesystem::path& work, Use use = Use::alone);
  ~WorkLock();
  WorkLock(const WorkLock&) = delete;
  WorkLock& operator=(const WorkLock&) = delete;

  /// Is the folder still the one that was locked?
  bool is_there() const;
  /// Throws core::SystemError where it was removed or replaced meanwhile.
  void expect_there() const;

 private:
  std::filesystem::path file_;
  int fd_;
};

/// Folders of stages in the work folder that are not one of the `valid`: work of another plan, or of other inputs.
std::set<std::string> foreign_folders(const std::filesystem::path& work, const std::set<std::string>& valid);

/// Whatever lies in the work folder and is not one of the `valid` folders goes.
void sweep(const std::filesystem::path& work, const std::set<std::string>& valid);

/// What an earlier run has left.
struct EarlierWork {
  std::uint64_t lines = 0, pieces = 0;  ///< whole: flight lines or files; pieces of the other stages
  std::uint64_t damaged = 0;            ///< pieces that were finished and are not what they were
};

/// Reads every piece of the work folder (piece_record.h) and removes whatever belongs to none that is whole, as do files that a kill left
/// half written: what stays is valid. `share`: how far it is, 0 to 1, from any thread.
EarlierWork keep_whole_work(const std::filesystem::path& work, const std::function<void(double)>& share = {});

}  // namespace swath::pipeline
