// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>

#include "core/config/result_visitors.h"
#include "io/text/value_file.h"

namespace swath::pipeline {
namespace {

constexpr double least_share = 0.02;  // of a step, from which its speed says how long the rest takes

std::chrono::milliseconds pause_of(Voice voice) { return std::chrono::milliseconds(voice == Voice::bar ? 100 : 3000); }

/// A line of --json-log: what a run says.
struct Message {
  std::string text;
};

template <class V>
void describe(const Message& m, V& v) {
  v.result("message", m.text, "A sentence.");
}

/// A line of --json-log: how far a step is.
struct Moment {
  std::string stage, unit, now;
  std::optional<std::uint64_t> done, total, step, steps;
  double per_second = 0.0, seconds = 0.0;
  std::optional<double> share, seconds_left, run_seconds_left;
  bool finished = false;
};

template <class V>
void describe(const Moment& m, V& v) {
  v.result("stage", m.stage, "The step at work.");
  v.result("done", m.done, "What it has worked on.");
  v.result("total", m.total, "What there is to work on.");
  v.result("unit", m.unit, core::plain().only_if(m.total.has_value()), "Unit of both.");
  v.result("per_second", m.per_second, "Rate of this run's work.");
  v.result("seconds", m.seconds, core::seconds(), "Time since it began.");
  v.result("share", m.share, core::share(), "How far it is.");
  v.result("now", m.now, core::plain().only_if(!m.now.empty()), "What it is at.");
  v.result("step", m.step, "Number of the step in the run.");
  v.result("steps", m.steps, "Steps of the run.");
  v.result("seconds_left", m.seconds_left, core::seconds(), "Expected time to the end of the step.");
  v.result("run_seconds_left", m.run_seconds_left, core::seconds(), "Expected time to the end of the run.");
  v.result("finished", m.finished, core::plain().only_if(m.finished), "True at the end of a step.");
}

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
  if (voice_ != Voice::quiet) ticker_ = std::thread([this] { tick(); });
}

Progress::~Progress() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  if (ticker_.joinable()) ticker_.join();
  if (open_ && voice_ == Voice::bar) std::fputc('\n', stderr);
}

void Progress::expect(std::vector<double> steps) {
  const std::lock_guard lock(mutex_);
  expected_ = std::move(steps);
  steps_ = begun_ + expected_.size();
}

void Progress::begin(const std::string& what, std::uint64_t total, const std::string& unit, double work) {
  expect_wanted();
  const std::lock_guard lock(mutex_);
  what_ = what;
  unit_ = unit;
  now_.clear();
  total_ = total;
  work_ = work;
  done_ = skipped_ = 0;
  work_done_ = work_skipped_ = 0.0;
  share_ = -1.0, share_seconds_ = 0.0;
  expected_now_ = 0.0;
  if (!expected_.empty()) {
    expected_now_ = expected_.front();
    expected_.erase(expected_.begin());
    ++begun_;
  }
  began_ = shown_ = Clock::now();
  open_ = true;
  if (voice_ == Voice::bar) show(false);
}

void Progress::advance(std::uint64_t n, double work) { count(n, work, false); }
void Progress::skip(std::uint64_t n, double work) { count(n, work, true); }

void Progress::count(std::uint64_t n, double work, bool skipped) {
  expect_wanted();
  const std::lock_guard lock(mutex_);
  done_ += n;
  work_done_ += work;
  if (skipped) skipped_ += n, work_skipped_ += work;
  if (Clock::now() - shown_ >= pause_of(voice_)) show(false);
}

void Progress::share(double done, std::string_view now) {
  expect_wanted();
  const std::lock_guard lock(mutex_);
  now_ = now;
  if (const double share = std::clamp(done, 0.0, 1.0); share > share_) share_ = share, share_seconds_ = seconds();
  if (Clock::now() - shown_ >= pause_of(voice_)) show(false);
}

void Progress::end() {
  const std::lock_guard lock(mutex_);
  if (!open_) return;
  total_ = std::max(total_, done_);
  show(true);
  // What was skipped took no time and says nothing of the speed.
  const double skipped = work_ > 0.0  ? work_skipped_ / work_
                         : total_ > 0 ? static_cast<double>(skipped_) / static_cast<double>(total_)
                                      : 0.0;
  if (expected_now_ > 0.0 && skipped < 1.0) {
    spent_ += seconds();
    spent_expected_ += expected_now_ * (1.0 - skipped);
  }
  open_ = false;
}

void Progress::say(const std::string& text) {
  const std::lock_guard lock(mutex_);
  if (voice_ == Voice::quiet) return;
  if (voice_ == Voice::json) {
    std::fprintf(stderr, "%s\n", one_line(core::reported(Message{text})).c_str());
    return;
  }
  if (open_ && voice_ == Voice::bar) std::fputs("\r\033[K", stderr);
  std::fprintf(stderr, "%s\n", text.c_str());
}

void Progress::tick() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, pause_of(voice_), [this] { return ending_; }))
    if (open_ && Clock::now() - shown_ >= pause_of(voice_)) show(false);
}

double Progress::seconds() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }

/// Of the step, 0 to 1; negative where nothing says it.
double Progress::done_share() const {
  if (work_ > 0.0) return std::min(1.0, work_done_ / work_);
  if (total_ > 0) return std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_));
  return share_;
}

Progress::Left Progress::left() const {
  Left out;
  const double share = done_share(), time = seconds();
  double skipped = 0.0;
  if (work_ > 0.0)
    skipped = work_skipped_ / work_;
  else if (total_ > 0)
    skipped = static_cast<double>(skipped_) / static_cast<double>(total_);
  const double fresh = share - skipped;
  if (share >= 0.0 && fresh >= least_share) {
    // A share is said now and then: until the next one the time left falls. Where it is over by then, nothing is known.
    const double said = work_ > 0.0 || total_ > 0 ? time : share_seconds_;
    out.step = said * (1.0 - share) / fresh - (time - said);
  }
  // The time that the work so far took, per expected time.
  const double expected = spent_expected_ + (out.step >= 0.0 ? expected_now_ * fresh : 0.0);
  const double to_come = std::accumulate(expected_.begin(), expected_.end(), 0.0);
  if (expected <= 0.0 || expected_now_ <= 0.0) return out;
  const double scale = (spent_ + (out.step >= 0.0 ? time : 0.0)) / expected;
  const double now = out.step >= 0.0 ? out.step : std::max(0.0, scale * expected_now_ * (1.0 - skipped) - time);
  out.run = now + scale * to_come;
  return out;
}

void Progress::show(bool last) {
  if (voice_ == Voice::quiet) return;
  shown_ = Clock::now();
  if (voice_ == Voice::json)
    show_json(last);
  else
    show_text(last);
}

void Progress::show_json(bool last) {
  const double time = seconds(), share = last ? 1.0 : done_share();
  const Left l = left();
  Moment m;
  m.stage = what_;
  if (total_ > 0) m.done = done_, m.total = total_, m.unit = unit_;
  m.per_second = time > 0 ? static_cast<double>(done_ - skipped_) / time : 0.0;
  m.seconds = time;
  if (share >= 0.0) m.share = share;
  if (!last) m.now = now_;
  if (steps_ > 0) m.step = begun_, m.steps = steps_;
  if (!last && l.step >= 0.0) m.seconds_left = l.step;
  if (!last && l.run >= 0.0) m.run_seconds_left = l.run;
  m.finished = last;
  std::fprintf(stderr, "%s\n", one_line(core::reported(m)).c_str());
}

void Progress::show_text(bool last) {
  const double time = seconds(), share = last ? 1.0 : done_share();
  const Left l = left();
  std::string text;
  char part[64];
  std::snprintf(part, sizeof part, "%-22s ", what_.c_str());
  text += part;
  if (voice_ == Voice::bar) {
    text += '[';
    for (int i = 0; i < 20; ++i) text += i < static_cast<int>(share * 20) ? '#' : '.';
    text += "] ";
  }
  if (share >= 0.0)
    std::snprintf(part, sizeof part, "%3.0f %%  ", std::floor(100.0 * share));
  else
    std::snprintf(part, sizeof part, "       ");
  text += part;
  if (total_ > 0)
    text += count_text(static_cast<double>(done_)) + " " + unit_ + ", " +
            count_text(time > 0 ? static_cast<double>(done_ - skipped_) / time : 0.0) + "/s, ";
  if (!last && !now_.empty()) text += now_ + ", ";
  if (last || l.step < 0.0)
    text += duration_text(time);
  else
    text += duration_text(l.step) + " left";
  if (!last && steps_ > 1) {
    text += "; step " + std::to_string(begun_) + " of " + std::to_string(steps_);
    if (l.run >= 0.0) text += ", run: " + duration_text(l.run) + " left";
  }
  if (voice_ == Voice::bar)
    std::fprintf(stderr, "\r\033[K%s%s", text.c_str(), last ? "\n" : "");
  else
    std::fprintf(stderr, "%s\n", text.c_str());
  std::fflush(stderr);
}

}  // namespace swath::pipeline
