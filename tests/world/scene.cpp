// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/world/scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <stdexcept>

namespace swath::test {
namespace {

constexpr double flying_height = 800.0;

struct Return {
  double z;
  std::uint8_t truth;
};
using Echoes = std::function<std::vector<Return>(double x, double y, std::mt19937& random)>;

class Flight {
 public:
  explicit Flight(Scene& scene) : scene_(scene) {
    scene_.block.origin = {512300.0, 5402100.0, 0.0};
    core::add_columns(scene_.block, {core::Column::time});
  }

  void pulse(double x, double y, const Echoes& echoes, std::uint16_t strip) {
    std::vector<Return> returns = echoes(x, y, random_);
    std::sort(returns.begin(), returns.end(), [](const Return& a, const Return& b) { return a.z > b.z; });
    time_ += 1e-5;
    core::Block& b = scene_.block;
    for (size_t k = 0; k < returns.size(); ++k) {
      b.x.push_back(x);
      b.y.push_back(y);
      b.z.push_back(returns[k].z + noise_(random_));
      b.time.push_back(time_);
      b.return_number.push_back(static_cast<std::uint8_t>(k + 1));
      b.return_count.push_back(static_cast<std::uint8_t>(returns.size()));
      b.strip.push_back(strip);
      b.range.push_back(static_cast<float>(flying_height - returns[k].z));
      scene_.truth.push_back(returns[k].truth);
    }
  }

  void fly(const Echoes& echoes, const std::function<bool(double, double)>& sees, std::uint16_t strip) {
    std::uniform_real_distribution<double> within(0.0, 1.0);
    for (int j = 0; j < static_cast<int>(scene_height); ++j)
      for (int i = 0; i < static_cast<int>(scene_width); ++i) {
        const double x = i + within(random_);
        const double y = j + within(random_);
        if (sees(x, y)) pulse(x, y, echoes, strip);
      }
  }

 private:
  Scene& scene_;
  std::mt19937 random_{20050607};
  std::normal_distribution<double> noise_{0.0, scene_noise};
  double time_ = 1000.0;
};

bool everywhere(double, double) { return true; }

/// Houses of 12 m x 10 m every 40 m: flat roofs of 7 m and gable roofs of 5 to 8 m in turn.
double roof_above_ground(double x, double y) {
  const double u = std::fmod(x + 10.0, 40.0);
  const double v = std::fmod(y + 10.0, 40.0);
  if (u < 20.0 || u > 32.0 || v < 20.0 || v > 30.0) return 0.0;
  const bool gable = (static_cast<int>((x + 10.0) / 40.0) + static_cast<int>((y + 10.0) / 40.0)) % 2 == 1;
  return gable ? 8.0 - 0.6 * std::abs(v - 25.0) : 7.0;
}

}  // namespace

std::vector<std::string> scene_names() { return {"flat", "slope", "scarp", "bridge", "town", "forest", "water", "void", "strip_edge"}; }

Scene make_scene(const std::string& name) {
  using namespace core::point_class;
  Scene s;
  s.name = name;
  s.terrain = [](double, double) { return 100.0; };
  if (name == "slope") s.terrain = [](double x, double y) { return 100.0 + 0.25 * x - 0.1 * y; };
  if (name == "scarp") s.terrain = [](double x, double) { return x < 90.0 ? 100.0 : 106.0; };
  if (name == "bridge") s.terrain = [](double x, double) { return 100.0 - 6.0 * std::exp(-std::pow((x - 100.0) / 18.0, 2)); };
  if (name == "town") s.terrain = [](double x, double y) { return 100.0 + 0.04 * x + 0.02 * y; };
  if (name == "forest") s.terrain = [](double x, double y) { return 100.0 + 0.1 * x + 2.0 * std::sin(y / 25.0); };

  const auto terrain = s.terrain;
  Echoes echoes = [terrain](double x, double y, std::mt19937&) { return std::vector<Return>{{terrain(x, y), ground}}; };
  if (name == "bridge") {
    echoes = [terrain](double x, double y, std::mt19937&) {
      const bool deck = std::abs(y - 80.0) < 5.0 && std::abs(x - 100.0) < 30.0 && 100.0 - terrain(x, y) > 1.5;
      return std::vector<Return>{deck ? Return{100.0, bridge_deck} : Return{terrain(x, y), ground}};
    };
  } else if (name == "town") {
    echoes = [terrain](double x, double y, std::mt19937&) {
      const double roof = roof_above_ground(x, y);
      return std::vector<Return>{{terrain(x, y) + roof, roof > 0 ? building : ground}};
    };
  } else if (name == "forest") {
    echoes = [terrain](double x, double y, std::mt19937& random) {
      std::uniform_real_distribution<double> part(0.0, 1.0);
      const double z = terrain(x, y);
      std::vector<Return> out{{z + 10.0 + 8.0 * part(random), high_vegetation}};
      if (part(random) < 0.5) out.push_back({z + 3.0 + 5.0 * part(random), high_vegetation});
      if (part(random) < 0.4) out.push_back({z, ground});
      return out;
    };
  }

  std::function<bool(double, double)> sees = everywhere;
  if (name == "water") sees = [](double x, double y) { return std::hypot(x - 100.0, y - 80.0) > 35.0; };
  if (name == "void") sees = [](double x, double y) { return x < 70.0 || x > 130.0 || y < 40.0; };
  if (name == "strip_edge") sees = [](double x, double y) { return x + 0.5 * y < 150.0 + 4.0 * std::sin(y); };
  if (std::ranges::count(scene_names(), name) == 0) throw std::invalid_argument("no scene " + name);

  Flight flight(s);
  flight.fly(echoes, sees, 1);
  if (name == "strip_edge")
    flight.fly(
        echoes, [](double x, double) { return x > 60.0 && x < 110.0; }, 2);
  core::add_columns(s.block, {core::Column::classification, core::Column::flags});
  return s;
}

void add_point(core::Block& b, double x, double y, double z) {
  core::resize(b, b.size() + 1);
  b.x.back() = x;
  b.y.back() = y;
  b.z.back() = z;
}

core::Block shuffled(const core::Block& b, unsigned seed, std::vector<std::uint32_t>& rows) {
  rows.resize(b.size());
  std::iota(rows.begin(), rows.end(), 0u);
  std::mt19937 random(seed);
  std::shuffle(rows.begin(), rows.end(), random);
  return core::select(b, rows);
}

core::Block run_tiled(const core::Block& whole, double side, double halo, const std::function<void(core::Block&, size_t)>& filter) {
  core::Block out = whole;
  core::add_columns(out, {core::Column::classification, core::Column::flags, core::Column::ground_probability});
  std::map<std::pair<int, int>, std::vector<std::uint32_t>> tiles;
  const auto map_x = [&](size_t p) { return whole.origin.x() + whole.x[p]; };
  const auto map_y = [&](size_t p) { return whole.origin.y() + whole.y[p]; };
  for (std::uint32_t p = 0; p < whole.size(); ++p)
    tiles[{static_cast<int>(std::floor(map_x(p) / side)), static_cast<int>(std::floor(map_y(p) / side))}].push_back(p);
  for (const auto& [key, own] : tiles) {
    std::vector<std::uint32_t> rows = own;
    const double x0 = key.first * side, y0 = key.second * side, x1 = x0 + side, y1 = y0 + side;
    for (std::uint32_t p = 0; p < whole.size(); ++p) {
      const double x = map_x(p), y = map_y(p);
      const bool inside = x >= x0 && x < x1 && y >= y0 && y < y1;
      if (!inside && x >= x0 - halo && x < x1 + halo && y >= y0 - halo && y < y1 + halo) rows.push_back(p);
    }
    core::Block tile = core::select(whole, rows);
    filter(tile, own.size());
    core::add_columns(tile, {core::Column::classification, core::Column::flags, core::Column::ground_probability});
    for (size_t k = 0; k < own.size(); ++k) {
      out.classification[own[k]] = tile.classification[k];
      out.flags[own[k]] = tile.flags[k];
      out.ground_probability[own[k]] = tile.ground_probability[k];
    }
  }
  return out;
}

}  // namespace swath::test
