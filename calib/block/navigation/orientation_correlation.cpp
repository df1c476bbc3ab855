// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/navigation/orientation_correlation.h"

#include <algorithm>
#include <cstdio>
#include <unordered_map>

#include "core/error.h"
#include "core/printable.h"
#include "io/text/text_table.h"

namespace swath::calib {
namespace {

std::string entry(int r, int c) { return "c" + std::to_string(r + 1) + std::to_string(c + 1); }

}  // namespace

std::string correlation_csv(const OrientationCorrelation& correlation, const std::string& crs) {
  std::string out =
      "# crs: " + crs +
      "; covariance of the errors (estimated less true) of `image` (rows) and `other` (columns): east, north, up of the grid (m), "
      "rotation w (rad) about the body's axes forward, right, down, body_R_map = exp(w) body_R_map_true\n"
      "# given the others of its rows, the errors of an image depend on no other image before it\n"
      "# lever arm and boresight are not in here: their errors are those of all images, sigma.antenna and sigma.boresight of [[camera]]\n"
      "image,other";
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) out += "," + entry(r, c);
  out += "\n";
  char text[32];
  for (const CovariancePair& p : correlation.pairs) {
    out += core::csv_field(correlation.images[p.image]) + "," + core::csv_field(correlation.images[p.other]);
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 6; ++c) {
        std::snprintf(text, sizeof text, ",%.12e", p.value(r, c));
        out += text;
      }
    out += "\n";
  }
  return out;
}

OrientationCorrelation read_correlation(const std::filesystem::path& file) {
  const io::TextTable table(file);
  const size_t image = table.column("image"), other = table.column("other");
  std::array<size_t, 36> columns{};
  for (int k = 0; k < 36; ++k) columns[static_cast<size_t>(k)] = table.column(entry(k / 6, k % 6));
  OrientationCorrelation out;
  std::unordered_map<std::string, std::uint32_t> number;
  size_t own = 0;  // rows of images with themselves
  for (size_t r = 0; r < table.rows(); ++r) {
    const auto [it, is_new] = number.try_emplace(table.text(r, image), static_cast<std::uint32_t>(out.images.size()));
    if (is_new) out.images.push_back(it->first);
    if (is_new && own + 1 != out.images.size())
      throw core::Error("image " + out.images[out.images.size() - 2] + " has no row with itself", table.place(r));
    if (!is_new && (it->second + 1 != out.images.size() || own == out.images.size()))
      throw core::Error("rows of image " + it->first + " do not follow one another, that with itself last", table.place(r));
    const auto before = number.find(table.text(r, other));
    if (before == number.end())
      throw core::Error("image " + it->first + " is paired with " + table.text(r, other) + ", which comes later or not at all",
                        table.place(r), "list each pair with the image that comes later in the order of time");
    for (size_t k = out.pairs.size(); k-- > 0 && out.pairs[k].image == it->second;)
      if (out.pairs[k].other == before->second) throw core::Error("this pair of images is there twice", table.place(r));
    CovariancePair p{it->second, before->second, {}};
    for (int k = 0; k < 36; ++k) p.value(k / 6, k % 6) = table.number(r, columns[static_cast<size_t>(k)]);
    own += p.image == p.other;
    out.pairs.push_back(p);
  }
  if (own != out.images.size()) throw core::Error("image " + out.images.back() + " has no row with itself", file.string());
  return out;
}

}  // namespace swath::calib
