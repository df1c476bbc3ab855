// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/navigation/orientation_correlation.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <unordered_map>

#include "calib/block/orientation_table.h"
#include "core/error.h"
#include "core/geo/same_map.h"
#include "core/printable.h"
#include "io/text/data_lines.h"
#include "io/text/delimited.h"

namespace swath::calib {
namespace {

std::string entry(int r, int c) { return "c" + std::to_string(r + 1) + std::to_string(c + 1); }

void expect_symmetric(const PoseCovariance& C, const std::string& image, const io::DataLine& line) {
  constexpr double rounding = 1e-6;  // of a correlation
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < r; ++c)
      if (std::abs(C(r, c) - C(c, r)) > rounding * std::sqrt(C(r, r) * C(c, c)))
        line.fault("the covariance of image " + image + " with itself is not symmetric: " + entry(r, c) + " is not " + entry(c, r),
                   "both halves of the matrix must be there");
}

/// Takes the lines of a file one after another.
class CorrelationLines {
 public:
  explicit CorrelationLines(const std::filesystem::path& file) : file_(file) {
    io::for_each_data_line(
        file, [&](const std::string& line) { return layout_.delimiter = io::delimiter_in(line); },
        [&](io::DataLine& line) { layout_.names.empty() ? take_header(line) : take_row(line); },
        [&](const std::string& text) { take_comment(text); });
    if (out_.images.empty())
      throw core::Error("no row of data", file.string(), "rows of images, other images and 36 covariances are expected");
    if (own_ != out_.images.size()) throw core::Error("image " + out_.images.back() + " has no row with itself", file.string());
  }
  OrientationCorrelation result() { return std::move(out_); }

 private:
  void take_comment(const std::string& text) {
    if (out_.crs.empty()) out_.crs = crs_of_comment(text);
  }
  void take_header(io::DataLine& line) {
    layout_.names = line.fields;
    layout_.columns = line.fields.size();
    image_ = io::column_of(layout_, "image", file_), other_ = io::column_of(layout_, "other", file_);
    for (int k = 0; k < 36; ++k) columns_[static_cast<size_t>(k)] = io::column_of(layout_, entry(k / 6, k % 6), file_);
  }
  void take_row(const io::DataLine& line) {
    line.expect_columns(layout_.columns);
    CovariancePair p = pair_of(line);
    for (int k = 0; k < 36; ++k) p.value(k / 6, k % 6) = line.number(columns_[static_cast<size_t>(k)]);
    if (p.image == p.other) expect_symmetric(p.value, out_.images[p.image], line);
    own_ += p.image == p.other;
    out_.pairs.push_back(p);
  }
  CovariancePair pair_of(const io::DataLine& line) {
    const std::string &image = line.fields[image_], &other = line.fields[other_];
    const auto [it, is_new] = number_.try_emplace(image, static_cast<std::uint32_t>(out_.images.size()));
    if (is_new) out_.images.push_back(image);
    if (is_new && own_ + 1 != out_.images.size())
      throw core::Error("image " + out_.images[out_.images.size() - 2] + " has no row with itself", line.place);
    if (!is_new && (it->second + 1 != out_.images.size() || own_ == out_.images.size()))
      throw core::Error("rows of image " + image + " do not follow one another, that with itself last", line.place);
    const auto before = number_.find(other);
    if (before == number_.end())
      line.fault("image " + image + " is paired with " + other + ", which comes later or not at all",
                 "list each pair with the image that comes later in the order of time");
    for (size_t k = out_.pairs.size(); k-- > 0 && out_.pairs[k].image == it->second;)
      if (out_.pairs[k].other == before->second) throw core::Error("this pair of images is there twice", line.place);
    return {it->second, before->second, {}};
  }

  const std::filesystem::path& file_;
  io::DelimitedLayout layout_;
  size_t image_ = 0, other_ = 0;
  std::array<size_t, 36> columns_{};
  OrientationCorrelation out_;
  std::unordered_map<std::string, std::uint32_t> number_;
  size_t own_ = 0;  // rows of images with themselves
};

bool is_same_grid(const std::string& a, const std::string& b) {
  if (a == b) return true;
  if (a == "local" || b == "local") return false;
  return core::is_same_map(core::Crs(a), core::Crs(b));
}

}  // namespace

CorrelationFile::CorrelationFile(const std::filesystem::path& file, const std::string& crs)
    : file_(file),
      to_(file_.temporary(), file),
      text_("# crs: " + crs +
            "; covariance of the errors (estimated less true) of `image` (rows) and `other` (columns): east, north, up of the grid (m), "
            "rotation w (rad) about the body's axes forward, right, down, body_R_map = exp(w) body_R_map_true\n"
            "# given the others of its rows, the errors of an image depend on no other image before it\n"
            "# lever arm and boresight are not in here: their errors are those of all images, sigma.antenna and sigma.boresight of "
            "[[camera]]\nimage,other") {
  for (int k = 0; k < 36; ++k) text_ += "," + entry(k / 6, k % 6);
  text_ += "\n";
}

void CorrelationFile::add(const std::string& image, const std::string& other, const PoseCovariance& value) {
  text_ += core::csv_field(image) + "," + core::csv_field(other);
  char number[32];
  for (int k = 0; k < 36; ++k) {
    // Of the variance of an error 1e-8 is left given ten images 0.5 s apart: ten digits changed that sigma by 24 %.
    std::snprintf(number, sizeof number, ",%.12e", value(k / 6, k % 6));
    text_ += number;
  }
  text_ += "\n";
  constexpr size_t portion = 1 << 20;  // bytes
  if (text_.size() > portion) flush();
}

void CorrelationFile::flush() {
  to_.append(text_.data(), text_.size());
  text_.clear();
}

void CorrelationFile::commit() {
  flush();
  to_.close();
  file_.commit();
}

OrientationCorrelation read_correlation(const std::filesystem::path& file) { return CorrelationLines(file).result(); }

void expect_grid(const OrientationCorrelation& correlation, const std::string& crs, const std::string& file) {
  if (!correlation.crs.empty() && !is_same_grid(correlation.crs, crs))
    throw core::Error("its covariances are on the grid of " + correlation.crs + ", the block is on that of " + crs, file,
                      "take stations and correlation of the same CRS, and state it as crs of the block");
}

}  // namespace swath::calib
