// SPDX-License-Identifier: GPL-3.0-or-later
// Labels of a ground filter against true ones.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "core/block.h"
#include "tests/world/scene.h"
#include "tests/world/support.h"

namespace swath::test {

struct GroundErrors {
  double ground = 0, object = 0, missed_ground = 0, taken_object = 0;

  double all() const { return ground + object; }
  double type_1() const { return ground > 0 ? 100.0 * missed_ground / ground : 0.0; }  ///< %
  double type_2() const { return object > 0 ? 100.0 * taken_object / object : 0.0; }   ///< %
  double total() const { return 100.0 * (missed_ground + taken_object) / all(); }      ///< %
  /// Cohen's kappa, %.
  double kappa() const {
    const double agreed = 1.0 - (missed_ground + taken_object) / all();
    const double said_ground = ground - missed_ground + taken_object;
    const double by_chance = (ground * said_ground + object * (all() - said_ground)) / (all() * all());
    return 100.0 * (agreed - by_chance) / (1.0 - by_chance);
  }
};

inline GroundErrors ground_errors(const core::Block& b, const std::vector<std::uint8_t>& truth) {
  GroundErrors e;
  for (size_t p = 0; p < b.size(); ++p) {
    const bool is_ground = truth[p] == core::point_class::ground;
    const bool said_ground = b.classification[p] == core::point_class::ground;
    ++(is_ground ? e.ground : e.object);
    e.missed_ground += is_ground && !said_ground;
    e.taken_object += !is_ground && said_ground;
  }
  return e;
}

/// x, y, z and class of an uncompressed LAS file of a legacy point format (ASPRS LAS 1.2, 2.3 and 2.4).
inline core::Block read_plain_las(const std::filesystem::path& file, std::vector<std::uint8_t>& truth) {
  const std::string bytes = read_bytes(file);
  const auto get = [&]<class T>(T& v, size_t at) { std::memcpy(&v, bytes.data() + at, sizeof v); };
  std::uint32_t data = 0, count = 0;
  std::uint16_t length = 0;
  double scale[3], offset[3];
  get(data, 96);
  get(length, 105);
  get(count, 107);
  get(scale, 131);
  get(offset, 155);
  core::Block b;
  b.origin = {500000.0, 5400000.0, 0.0};
  core::resize(b, count);
  truth.resize(count);
  for (size_t p = 0; p < count; ++p) {
    std::int32_t raw[3];
    get(raw, data + p * length);
    b.x[p] = raw[0] * scale[0] + offset[0] - b.origin.x();
    b.y[p] = raw[1] * scale[1] + offset[1] - b.origin.y();
    b.z[p] = raw[2] * scale[2] + offset[2];
    get(truth[p], data + p * length + 15);
    truth[p] &= 31;
  }
  return b;
}

/// Largest errors that a made scene may come out with.
struct SceneBar {
  const char* scene;
  double type_1, type_2;  // %
};

template <class Run>
void expect_within(const std::vector<SceneBar>& bars, Run&& run) {
  for (const SceneBar& bar : bars) {
    Scene s = make_scene(bar.scene);
    run(s.block, s.block.size());
    const GroundErrors e = ground_errors(s.block, s.truth);
    std::printf("%s: type I %.2f %%, type II %.2f %%\n", bar.scene, e.type_1(), e.type_2());
    EXPECT_LE(e.type_1(), bar.type_1) << bar.scene;
    EXPECT_LE(e.type_2(), bar.type_2) << bar.scene;
  }
}

/// Withheld points, noise and the halo keep their class; an early return is never ground.
template <class Run>
void expect_only_own_last_returns_judged(Run&& run) {
  Scene s = make_scene("flat");
  s.block.classification[0] = core::point_class::low_noise;
  s.block.flags[1] = core::flag::withheld;
  s.block.return_count[2] = 2;  // a first return lying on the ground
  const size_t own = s.block.size() - 10;
  const auto n = run(s.block, own);
  EXPECT_EQ(n.untouched, 2u);
  EXPECT_EQ(n.early, 1u);
  EXPECT_EQ(n.ground + n.object, own - 2);
  EXPECT_GT(n.ground, own - own / 100);
  EXPECT_EQ(s.block.classification[0], core::point_class::low_noise);
  EXPECT_EQ(s.block.classification[1], core::point_class::never_classified);
  EXPECT_EQ(s.block.classification[2], core::point_class::unassigned);
  EXPECT_EQ(s.block.classification[own], core::point_class::never_classified);
  core::Block empty;
  EXPECT_EQ(run(empty, 0).ground, 0u);
}

/// Type I and II, total and kappa on one of the reference samples, within a bar for the total error (%).
template <class Run>
void expect_sample_within(const std::filesystem::path& folder, const std::string& name, double total_bar, Run&& run) {
  std::vector<std::uint8_t> truth;
  core::Block b = read_plain_las(folder / (name + "-utm.las"), truth);
  ASSERT_GT(b.size(), 7000u);
  run(b, b.size());
  const GroundErrors e = ground_errors(b, truth);
  std::printf("%s: type I %.2f %%, type II %.2f %%, total %.2f %% (bar %.1f), kappa %.1f %%\n", name.c_str(), e.type_1(), e.type_2(),
              e.total(), total_bar, e.kappa());
  EXPECT_LE(e.total(), total_bar) << name;
}

/// Share of the labels (%) that differ when a scene is moved by a fraction of every lattice, which moves all seams between patches.
template <class Run>
double labels_that_hang_on_the_seams(const std::string& scene, Run&& run) {
  Scene s = make_scene(scene);
  core::Block moved = s.block;
  moved.origin += Eigen::Vector3d(23.0, 17.0, 0.0);
  run(s.block, s.block.size());
  run(moved, moved.size());
  double different = 0;
  for (size_t p = 0; p < moved.size(); ++p) different += moved.classification[p] != s.block.classification[p];
  return 100.0 * different / static_cast<double>(moved.size());
}

}  // namespace swath::test
