// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/line_reader.h"

#include <charconv>
#include <cstring>

namespace swath::io {
namespace {

constexpr size_t longest = 1 << 16;

}  // namespace

LineReader::LineReader(const std::filesystem::path& file) : file_(file), buffer_(4 * longest) {}

bool LineReader::next(std::string_view& line) {
  const auto find = [&] { return static_cast<const char*>(std::memchr(buffer_.data() + begin_, '\n', fill_ - begin_)); };
  const char* end = find();
  if (!end && fill_ - begin_ < longest) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, fill_ - begin_);
    fill_ -= begin_;
    begin_ = 0;
    const size_t got = file_.read_some(file_at_, buffer_.data() + fill_, buffer_.size() - fill_);
    fill_ += got;
    file_at_ += got;
    end = find();
  }
  if (begin_ == fill_) return false;
  size_t length = end ? static_cast<size_t>(end - (buffer_.data() + begin_)) : fill_ - begin_;
  const bool cut = length > longest;
  if (cut) length = longest;
  line = {buffer_.data() + begin_, length};
  begin_ += length + (end && !cut ? 1 : 0);
  ++line_;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return true;
}

std::string LineReader::place() const { return file_.path().string() + ":" + std::to_string(line_); }

std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view between = " \t,;";
  std::vector<std::string_view> out;
  for (size_t at = line.find_first_not_of(between); at != std::string_view::npos; at = line.find_first_not_of(between, at)) {
    const size_t stop = std::min(line.find_first_of(between, at), line.size());
    out.push_back(line.substr(at, stop - at));
    at = stop;
  }
  return out;
}

bool read_number(std::string_view text, double& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), value);
  return bad == std::errc{} && end == text.data() + text.size() && !text.empty();
}

}  // namespace swath::io
