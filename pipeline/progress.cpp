// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "core/value.h"
#include "io/value_file.h"

namespace swath::pipeline {
namespace {

/// JSON on one line.
std::string one_line(const core::Value& v) {
  std::string text = io::to_json(v), out;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\n') {
      out += text[i];
      continue;
    }
    while (i + 1 < text.size() && text[i + 1] == ' ') ++i;
  }
  return out;
}

}  // namespace

std::string duration_text(double seconds) {
  char buf[48];
  if (seconds < 60)
    std::snprintf(buf, sizeof buf, "%.1f s", seconds);
  else if (seconds < 3600)
    std::snprintf(buf, sizeof buf, "%d m %02d s", static_cast<int>(seconds) / 60, static_cast<int>(seconds) % 60);
  else
    std::snprintf(buf, sizeof buf, "%d h %02d m", static_cast<int>(seconds) / 3600, static_cast<int>(seconds) / 60 % 60);
  return buf;
}

std::string count_text(double n) {
  char buf[32];
  if (n >= 1e9)
    std::snprintf(buf, sizeof buf, "%.2f G", n / 1e9);
  else if (n >= 1e6)
    std::snprintf(buf, sizeof buf, "%.2f M", n / 1e6);
  else if (n >= 1e4)
    std::snprintf(buf, sizeof buf, "%.1f k", n / 1e3);
  else
    std::snprintf(buf, sizeof buf, "%.0f", n);
  return buf;
}

Progress::Progress(Voice voice) : voice_(voice) {
  if (voice_ == Voice::bar && !isatty(STDERR_FILENO)) voice_ = Voice::lines;
}

Progress::~Progress() {
  if (open_ && voice_ == Voice::bar) std::fputc('\n', stderr);
}

void Progress::begin(const std::string& what, std::uint64_t total, const std::string& unit) {
  const std::lock_guard lock(mutex_);
  what_ = what;
  unit_ = unit;
  total_ = total;
  done_ = 0;
  began_ = shown_ = std::chrono::steady_clock::now();
  open_ = true;
  if (voice_ == Voice::bar) show(false);
}

void Progress::advance(std::uint64_t n) {
  const std::lock_guard lock(mutex_);
  done_ += n;
  const auto pause = voice_ == Voice::bar ? std::chrono::milliseconds(100) : std::chrono::milliseconds(3000);
  if (std::chrono::steady_clock::now() - shown_ < pause) return;
  shown_ = std::chrono::steady_clock::now();
  show(false);
}

void Progress::end() {
  const std::lock_guard lock(mutex_);
  if (!open_) return;
  total_ = std::max(total_, done_);
  show(true);
  open_ = false;
}

void Progress::say(const std::string& text) {
  const std::lock_guard lock(mutex_);
  if (voice_ == Voice::quiet) return;
  if (voice_ == Voice::json) {
    core::Value line;
    line["message"] = text;
    std::fprintf(stderr, "%s\n", one_line(line).c_str());
    return;
  }
  if (open_ && voice_ == Voice::bar) std::fputs("\r\033[K", stderr);
  std::fprintf(stderr, "%s\n", text.c_str());
}

void Progress::show(bool last) {
  if (voice_ == Voice::quiet) return;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  const double rate = seconds > 0 ? static_cast<double>(done_) / seconds : 0.0;
  const double share = total_ > 0 ? std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_)) : 0.0;
  const double left = rate > 0 ? static_cast<double>(total_ - std::min(total_, done_)) / rate : 0.0;
  if (voice_ == Voice::json) {
    core::Value line;
    line["stage"] = what_;
    line["done"] = done_;
    line["total"] = total_;
    line["unit"] = unit_;
    line["per_second"] = rate;
    line["seconds"] = seconds;
    if (last) line["finished"] = true;
    std::fprintf(stderr, "%s\n", one_line(line).c_str());
    return;
  }
  char bar[24] = {};
  const int filled = static_cast<int>(share * 20);
  for (int i = 0; i < 20; ++i) bar[i] = i < filled ? '#' : '.';
  const std::string tail = last ? duration_text(seconds) : duration_text(left) + " left";
  if (voice_ == Voice::bar)
    std::fprintf(stderr, "\r\033[K%-22s [%s] %3.0f %%  %s %s, %s/s, %s%s", what_.c_str(), bar, 100 * share,
                 count_text(static_cast<double>(done_)).c_str(), unit_.c_str(), count_text(rate).c_str(), tail.c_str(), last ? "\n" : "");
  else
    std::fprintf(stderr, "%-22s %3.0f %%  %s %s, %s/s, %s\n", what_.c_str(), 100 * share, count_text(static_cast<double>(done_)).c_str(),
                 unit_.c_str(), count_text(rate).c_str(), tail.c_str());
  std::fflush(stderr);
}

}  // namespace swath::pipeline
