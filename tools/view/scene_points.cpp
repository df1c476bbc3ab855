// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "report/html.h"
#include "tools/view/scene.h"

namespace swath::tools {
namespace {

constexpr double rim = 0.001;             // share of points beyond either end of the box that the view opens on: stray ones are far away
constexpr std::uint16_t unknown = 65535;  // a sigma

std::vector<std::int32_t> steps_of(const std::vector<double>& values, double scale) {
  std::vector<std::int32_t> out;
  out.reserve(values.size());
  for (const double v : values) out.push_back(static_cast<std::int32_t>(std::llround(v / scale)));
  return out;
}

std::vector<std::uint16_t> millimetres_of(const std::vector<float>& sigmas) {
  std::vector<std::uint16_t> out;
  out.reserve(sigmas.size());
  for (const float s : sigmas) {
    const double mm = std::round(static_cast<double>(s) * 1000.0);
    out.push_back(mm >= 0.0 && mm < unknown ? static_cast<std::uint16_t>(mm) : unknown);
  }
  return out;
}

core::Value list_of(const Eigen::Vector3d& v) {
  core::Value out = core::Value::array();
  for (int k = 0; k < 3; ++k) out.push(v[k]);
  return out;
}

/// Corners of the usable points but for a rim.
void add_box(core::Value& about, const core::Block& b) {
  Eigen::Vector3d low, high;
  for (int k = 0; k < 3; ++k) {
    const std::vector<double>& column = k == 0 ? b.x : k == 1 ? b.y : b.z;
    std::vector<double> values;
    for (std::size_t i = 0; i < b.size(); ++i)
      if (core::is_usable(b, i)) values.push_back(column[i]);
    if (values.empty()) values = column;
    const auto last = static_cast<double>(values.size() - 1);
    const auto nth = [&](double share) {
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::llround(share * last));
      std::nth_element(values.begin(), at, values.end());
      return *at + b.origin[k];
    };
    low[k] = nth(rim);
    high[k] = nth(1.0 - rim);
  }
  about["low"] = list_of(low);
  about["high"] = list_of(high);
}

}  // namespace

void add_points(Scene& scene, CloudSources clouds, const SceneOptions& options, const core::OnProgress& progress) {
  const CloudSample sample = sample_clouds(std::move(clouds), options.points, progress);
  const core::Block& b = sample.points;
  core::Value& about = scene.table["points"];
  about["shown"] = static_cast<std::uint64_t>(b.size());
  about["of"] = sample.of;
  about["scale"] = list_of(sample.scale);
  about["offset"] = list_of(b.origin);
  add_box(about, b);
  Packer packer("points");
  packer.add("x", std::span<const std::int32_t>(steps_of(b.x, sample.scale.x())));
  packer.add("y", std::span<const std::int32_t>(steps_of(b.y, sample.scale.y())));
  packer.add("z", std::span<const std::int32_t>(steps_of(b.z, sample.scale.z())));
  if (!b.classification.empty()) packer.add("class", std::span<const std::uint8_t>(b.classification));
  if (std::any_of(b.intensity.begin(), b.intensity.end(), [](auto v) { return v > 0; }))
    packer.add("intensity", std::span<const std::uint16_t>(b.intensity));
  if (!b.return_number.empty() && !b.return_count.empty()) {
    std::vector<std::uint8_t> returns;
    for (std::size_t i = 0; i < b.size(); ++i)
      returns.push_back(static_cast<std::uint8_t>((b.return_number[i] & 15) | (b.return_count[i] & 15) << 4));
    packer.add("returns", std::span<const std::uint8_t>(returns));
  }
  if (!b.strip.empty()) packer.add("line", std::span<const std::uint16_t>(b.strip));
  if (!b.sigma_h.empty()) packer.add("sigma_h", std::span<const std::uint16_t>(millimetres_of(b.sigma_h)));
  if (!b.sigma_v.empty()) packer.add("sigma_v", std::span<const std::uint16_t>(millimetres_of(b.sigma_v)));
  about["columns"] = packer.table;
  std::move(packer.blobs.begin(), packer.blobs.end(), std::back_inserter(scene.blobs));
  scene.about = (options.streams ? std::string() : report::count_text(b.size()) + " of ") + report::count_text(sample.of) + " points";
}

}  // namespace swath::tools
