// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/work_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <regex>
#include <vector>

#include "core/error.h"
#include "io/text/output_file.h"
#include "pipeline/delivery.h"
#include "pipeline/work/piece_record.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char *lock_name = "lock", *discarded_name = "discarded", *products_name = "products", *groups_name = "groups.done",
                     *strip_name = "strip.json", *unfinished_name = "files.done";

/// "03-filters.ground-0123456789abcdef": the folder of a stage.
bool is_stage_folder(const fs::directory_entry& entry) {
  static const std::regex form("[0-9]{2,}-[a-z0-9._]+-[0-9a-f]{16}");
  return entry.is_directory() && !entry.is_symlink() && std::regex_match(entry.path().filename().string(), form);
}

bool is_record(const fs::path& file) { return file.extension() == ".done" || file.filename() == strip_name; }

std::vector<fs::path> records_in(const fs::path& stage) {
  std::vector<fs::path> out;
  for (auto at = fs::recursive_directory_iterator(stage); at != fs::recursive_directory_iterator(); ++at) {
    if (at->is_directory() && at.depth() == 0 && at->path().filename() == products_name) at.disable_recursion_pending();
    if (!at->is_directory() && is_record(at->path())) out.push_back(at->path());
  }
  return out;
}

/// The record's files, itself among them; none where the piece is not whole.
std::vector<fs::path> files_of_whole(const fs::path& record) {
  try {
    const std::optional<PieceRecord> read = read_record(record);
    const fs::path folder = record.parent_path();
    // Whether the run can do without points that were released it looks for itself.
    const bool is_released = record.filename() == strip_name && fs::exists(folder.parent_path() / released_name);
    if (!read || !is_whole(*read, folder, is_released)) return {};
    std::vector<fs::path> out{record};
    for (const PieceFile& f : read->files) out.push_back(folder / f.name);
    return out;
  } catch (const core::SystemError&) {
    return {};  // a disk that cannot read it back
  }
}

/// Removes what is in none of `kept`, and the folders that hold nothing then.
void remove_others(const fs::path& stage, const std::set<fs::path>& kept) {
  std::vector<fs::path> files, folders;
  for (const auto& entry : fs::recursive_directory_iterator(stage)) {
    if (entry.is_directory() && !entry.is_symlink())
      folders.push_back(entry.path());
    else if (!kept.contains(entry.path()))
      files.push_back(entry.path());
  }
  std::error_code ec;
  for (const fs::path& file : files)
    if (!fs::remove(file, ec) && ec) io::throw_system_error("cannot remove what is damaged", file, ec.value());
  std::sort(folders.rbegin(), folders.rend());  // the inner ones first
  for (const fs::path& folder : folders)
    if (fs::is_empty(folder, ec)) fs::remove(folder, ec);
}

}  // namespace

void expect_own(const fs::path& folder) {
  std::error_code ec;
  const fs::file_status status = fs::symlink_status(folder, ec);
  if (!fs::exists(status)) return;
  const std::string name = folder.filename().string();
  const std::string hint = "swath empties the folder " + name + " of its output: move what is there away, or choose another --output";
  if (!fs::is_directory(status))
    throw core::usage_error(fs::is_symlink(status) ? "it is a link" : "it is not a folder", folder.string(), hint);
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string file = entry.path().filename().string();
    if (file == lock_name && entry.is_regular_file() && !entry.is_symlink()) continue;
    if (file == discarded_name && entry.is_directory() && !entry.is_symlink()) continue;
    if (!is_stage_folder(entry)) throw core::usage_error("it holds '" + file + "', which no run of swath has made", folder.string(), hint);
  }
}

WorkLock::WorkLock(const fs::path& work, Use use)
    : file_(work / lock_name), fd_(::open(file_.c_str(), O_CREAT | O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0666)) {
  if (fd_ < 0) io::throw_system_error("cannot write", file_, errno);
  // Between the two calls the run that had the lock may have ended and removed the file, and another may have made it anew.
  const int way = use == Use::together ? LOCK_SH | LOCK_NB : use == Use::alone ? LOCK_EX | LOCK_NB : LOCK_EX;
  if (::flock(fd_, way) || !is_there()) {
    ::close(fd_);
    throw core::usage_error("another run is at work in this output folder", work.parent_path().string(),
                            "wait for it to end, or choose another --output");
  }
}

WorkLock::~WorkLock() { ::close(fd_); }

bool WorkLock::is_there() const {
  struct stat mine {
  }, there{};
  return ::fstat(fd_, &mine) == 0 && ::lstat(file_.c_str(), &there) == 0 && mine.st_ino == there.st_ino && mine.st_dev == there.st_dev;
}

void WorkLock::expect_there() const {
  if (is_there()) return;
  throw core::SystemError("the output folder was removed or replaced while the run was at work", file_.parent_path().parent_path().string(),
                          "run the same command again");
}

std::set<std::string> foreign_folders(const fs::path& work, const std::set<std::string>& valid) {
  std::set<std::string> out;
  for (const auto& entry : fs::directory_iterator(work))
    if (const std::string name = entry.path().filename().string(); is_stage_folder(entry) && !valid.contains(name)) out.insert(name);
  return out;
}

void sweep(const fs::path& work, const std::set<std::string>& valid) {
  std::vector<fs::path> gone;
  for (const auto& entry : fs::directory_iterator(work)) {
    const std::string name = entry.path().filename().string();
    if (name != lock_name && !valid.contains(name)) gone.push_back(entry.path());
  }
  for (const fs::path& folder : gone) discard(folder, work / discarded_name);
}

EarlierWork keep_whole_work(const fs::path& work, const std::function<void(double)>& share) {
  std::vector<fs::path> stages, records;
  for (const auto& entry : fs::directory_iterator(work))
    if (is_stage_folder(entry)) stages.push_back(entry.path());
  for (const fs::path& stage : stages) {
    const std::vector<fs::path> mine = records_in(stage);
    records.insert(records.end(), mine.begin(), mine.end());
  }
  std::vector<std::vector<fs::path>> whole(records.size());
  std::atomic<size_t> looked_at{0};
  tbb::parallel_for(size_t{0}, records.size(), [&](size_t i) {
    whole[i] = files_of_whole(records[i]);
    if (share) share(static_cast<double>(++looked_at) / static_cast<double>(records.size()));
  });
  EarlierWork out;
  std::set<fs::path> kept;
  for (size_t i = 0; i < records.size(); ++i) {
    out.damaged += whole[i].empty();
    if (whole[i].empty()) continue;
    if (records[i].filename() != groups_name && records[i].filename() != unfinished_name && records[i].filename() != released_name)
      ++(records[i].extension() == ".done" ? out.pieces : out.lines);
    kept.insert(whole[i].begin(), whole[i].end());
  }
  for (const fs::path& stage : stages) remove_others(stage, kept);
  return out;
}

}  // namespace swath::pipeline
