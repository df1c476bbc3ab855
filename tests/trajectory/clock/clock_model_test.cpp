// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/clock/clock_model.h"

#include <gtest/gtest.h>
#include <rapidjson/document.h>

#include <cmath>
#include <functional>
#include <random>
#include <sstream>

#include "core/error.h"
#include "core/time.h"
#include "tests/world/support.h"

namespace swath::trajectory {
namespace {

/// Normal numbers that are the same everywhere (Box and Muller on the generator's own bits).
class Noise {
 public:
  explicit Noise(unsigned seed) : bits_(seed) {}
  double operator()() {
    const double u = (static_cast<double>(bits_()) + 0.5) / 4294967296.0, v = (static_cast<double>(bits_()) + 0.5) / 4294967296.0;
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * M_PI * v);
  }
  double uniform() { return (static_cast<double>(bits_()) + 0.5) / 4294967296.0; }

 private:
  std::mt19937 bits_;
};

/// A clock of its own, independent of the model: its drift walks, a loop may steer it, it may step. Once a second.
struct World {
  unsigned seed = 1;
  double seconds = 7200, poll = 16, drift0 = 2e-6;
  double walk = 1e-9;  // s/s per sqrt(s)
  bool steered = false;
  double wild_share = 0;  // of records that are wrong by 50 sigma
  double step_at = 1e9, step = 0;
  double offset0 = 0;
  std::function<double(double)> sigma = [](double) { return 5e-6; };
  bool with_jitter = false;

  std::vector<double> truth;  // UTC - clock at each second
  core::ClockData log;

  World& run() {
    Noise noise(seed);
    truth.clear();
    log = {};
    log.epoch = 1.4e9;
    log.steered = steered;
    double x = offset0, y = drift0, left = 0;  // left: of the last offset, still to be taken back
    for (int s = 0; s <= static_cast<int>(seconds); ++s) {
      if (s == static_cast<int>(step_at)) x += step;
      truth.push_back(x);
      if (std::fmod(s, poll) == 0) {
        const double r = sigma(s), wild = noise.uniform() < wild_share ? 50 * r : 0.0, seen = x + r * noise() + wild;
        log.time.push_back(s);
        log.offset.push_back(seen);
        if (with_jitter) log.jitter.push_back(r * (0.8 + 0.4 * noise.uniform()));
        if (steered) {  // ntpd's loop: 1/16 of the offset until the next, the frequency by the square of four times that
          left = seen;
          y -= seen * poll / (64 * poll * 64 * poll);
        }
      }
      const double taken = left / (16 * poll);
      left -= taken;
      x += y - taken;
      y += walk * noise();
    }
    return *this;
  }
  /// Between the seconds too.
  double at(double t) const {
    const auto k = static_cast<size_t>(t);
    const double w = t - static_cast<double>(k);
    return w == 0 ? truth[k] : (1 - w) * truth[k] + w * truth[k + 1];
  }
};

struct Score {
  double ratio = 0, rms = 0, literal = 0, n = 0;
};

/// rms of error/sigma, of the error and of the literal model's error over seeds, at instants between the records.
Score score(World world, int seeds, double from = 0) {
  Score out;
  ClockOptions literal;
  literal.model = ClockMethod::literal;
  for (int seed = 1; seed <= seeds; ++seed) {
    world.seed = static_cast<unsigned>(seed);
    world.run();
    const ClockModel robust(world.log), plain(world.log, literal);
    for (double t = from + 3.25; t < world.seconds - 16; t += 37.3) {
      const ClockReading r = robust.at(t);
      const double e = r.offset - world.at(t), p = plain.at(t).offset - world.at(t);
      out.ratio += e * e / (r.sigma * r.sigma);
      out.rms += e * e;
      out.literal += p * p;
      ++out.n;
    }
  }
  out.ratio = std::sqrt(out.ratio / out.n);
  out.rms = std::sqrt(out.rms / out.n);
  out.literal = std::sqrt(out.literal / out.n);
  return out;
}

// 30 seeds of 450 records and a memory of some ten records: about 1000 independent errors, so the ratio itself is known to 3 %; the rest is
// what strengths estimated from 64 records leave.
constexpr double ratio_low = 0.85, ratio_high = 1.15;

TEST(ClockModel, SigmaIsTrueOfAFreeClock) {
  World w;
  const Score s = score(w, 30);
  RecordProperty("ratio", std::to_string(s.ratio));
  std::printf("free: error/sigma %.3f, rms %.2f us, literal %.2f us\n", s.ratio, s.rms * 1e6, s.literal * 1e6);
  EXPECT_GT(s.ratio, ratio_low);
  EXPECT_LT(s.ratio, ratio_high);
  EXPECT_LT(s.rms, 0.7 * s.literal);
}

TEST(ClockModel, SigmaIsTrueOfARestlessAndOfAQuietClock) {
  for (const double walk : {1e-11, 1e-10, 1e-8, 1e-7}) {
    World w;
    w.walk = walk;
    const Score s = score(w, 30);
    std::printf("walk %g: error/sigma %.3f, rms %.2f us, literal %.2f us\n", walk, s.ratio, s.rms * 1e6, s.literal * 1e6);
    EXPECT_GT(s.ratio, walk < 5e-11 ? 0.6 : ratio_low) << walk;  // a clock quieter than 64 records can tell: sigma is on the safe side
    EXPECT_LT(s.ratio, ratio_high) << walk;
    EXPECT_LT(s.rms, s.literal);
  }
}

TEST(ClockModel, SigmaIsTrueWhereTheLogsNoiseChanges) {
  for (const bool jitter : {false, true}) {
    World w;
    w.sigma = [](double t) { return t < 1000 ? 1e-4 : 4e-6; };
    w.with_jitter = jitter;
    const Score late = score(w, 30, 2000);
    std::printf("changed noise, jitter %d: error/sigma %.3f, rms %.2f us, literal %.2f us\n", jitter, late.ratio, late.rms * 1e6,
                late.literal * 1e6);
    EXPECT_GT(late.ratio, ratio_low);
    EXPECT_LT(late.ratio, ratio_high);
    const Score all = score(w, 30);
    std::printf("   whole: error/sigma %.3f\n", all.ratio);
    EXPECT_GT(all.ratio, ratio_low);
    EXPECT_LT(all.ratio, ratio_high);
  }
}

TEST(ClockModel, SigmaIsTrueOfASteeredClock) {
  World w;
  w.steered = true;
  w.drift0 = 20e-6;
  const Score s = score(w, 30);
  std::printf("steered: error/sigma %.3f, rms %.2f us, literal %.2f us\n", s.ratio, s.rms * 1e6, s.literal * 1e6);
  EXPECT_GT(s.ratio, 0.8);
  EXPECT_LT(s.ratio, 1.2);
}

TEST(ClockModel, OutliersOfTheLogHaveNoPull) {
  World clean, wild;
  wild.wild_share = 0.03;
  const Score a = score(clean, 20), b = score(wild, 20);
  std::printf("outliers: error/sigma %.3f, rms %.2f us (without them %.2f us), literal %.2f us\n", b.ratio, b.rms * 1e6, a.rms * 1e6,
              b.literal * 1e6);
  EXPECT_LT(b.rms, 1.25 * a.rms);
  EXPECT_GT(b.ratio, 0.85);
  EXPECT_LT(b.ratio, 1.2);
  wild.seed = 5;
  wild.run();
  const ClockModel m(wild.log);
  EXPECT_EQ(m.stretches().size(), 1u) << "an outlier is no step";
  EXPECT_GT(m.outliers(), 3u);
}

TEST(ClockModel, StepsOfTheClockAreKeptApart) {
  for (const double step : {0.2, -1e-3, 2e-4})
    for (unsigned seed = 1; seed <= 10; ++seed) {
      World w;
      w.seed = seed;
      w.step_at = 3603;
      w.step = step;
      w.run();
      const ClockModel m(w.log);
      ASSERT_EQ(m.stretches().size(), 2u) << step << " seed " << seed;
      EXPECT_NEAR(m.stretches()[1].step, step, 5 * 5e-6);
      EXPECT_EQ(m.log().time[m.stretches()[1].first], 3616);
      // Either side as exact as ever, and nothing is known between the two records about it.
      for (const double t : {3590.0, 3620.0}) EXPECT_LT(std::abs(m.at(t).offset - w.at(t)), 6 * m.at(t).sigma) << t;
      for (const double t : {3601.0, 3612.0}) {
        EXPECT_FALSE(m.at(t).inside);
        EXPECT_GE(m.at(t).sigma, std::abs(step) * 0.8);
      }
      EXPECT_TRUE(m.at(3599).inside);
    }
}

TEST(ClockModel, ASteeredClockThatIsSwitchedOnHasNoStep) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    World w;
    w.seed = seed;
    w.steered = true;
    w.offset0 = 5e-3;
    w.drift0 = 60e-6;
    EXPECT_EQ(ClockModel(w.run().log).stretches().size(), 1u);
  }
}

TEST(ClockModel, ConvergenceIsSeenInTheLog) {
  World w;
  w.sigma = [](double t) { return t < 1000 ? 1.2e-4 : 4e-6; };
  for (unsigned seed = 1; seed <= 10; ++seed) {
    w.seed = seed;
    w.run();
    const double settled = ClockModel(w.log).stretches()[0].settled;
    EXPECT_GT(settled, 900) << seed;
    EXPECT_LT(settled, 1150) << seed;
  }
  // A clock that ran long before is settled from the first record; after a step it has to settle anew.
  w = World();
  EXPECT_EQ(ClockModel(w.run().log).stretches()[0].settled, 0);
  w.step_at = 3603;
  w.step = 0.1;
  w.sigma = [](double t) { return t > 3600 && t < 4600 ? 1e-4 : 4e-6; };
  const ClockModel again(w.run().log);
  ASSERT_EQ(again.stretches().size(), 2u);
  EXPECT_EQ(again.stretches()[0].settled, 0);
  EXPECT_NEAR(again.stretches()[1].settled, 4600, 100);
  ClockOptions fixed;
  fixed.convergence = Convergence::fixed;
  fixed.convergence_time = core::Seconds(500);
  EXPECT_EQ(ClockModel(w.log, fixed).stretches()[0].settled, 500);
  EXPECT_EQ(ClockModel(w.log, fixed).stretches()[1].settled, 3616 + 500);
  fixed.convergence = Convergence::none;
  EXPECT_TRUE(ClockModel(w.log, fixed).at(0).settled);
}

TEST(ClockModel, OutsideTheLogAndInGapsNothingIsPretended) {
  World w;
  w.run();
  core::ClockData log = w.log;
  const auto cut = [&](std::vector<double>& v) { v.erase(v.begin() + 100, v.begin() + 150); };  // 1584 to 2400 s
  cut(log.time);
  cut(log.offset);
  for (const ClockMethod method : {ClockMethod::robust, ClockMethod::literal}) {
    ClockOptions o;
    o.model = method;
    const ClockModel m(log, o);
    EXPECT_TRUE(m.at(1584).inside);
    EXPECT_FALSE(m.at(1990).inside);
    EXPECT_TRUE(m.at(2400).inside);
    EXPECT_FALSE(m.at(-1).inside);
    EXPECT_FALSE(m.at(7201).inside);
    EXPECT_TRUE(m.at(0).inside);
    EXPECT_TRUE(m.at(7200).inside);
    o.max_gap = core::Seconds(900);
    EXPECT_TRUE(ClockModel(log, o).at(1990).inside);
    if (method == ClockMethod::literal) {
      EXPECT_EQ(m.at(-100).offset, log.offset.front());
      EXPECT_EQ(m.at(9000).offset, log.offset.back());
      EXPECT_EQ(m.at(2000).sigma, 0) << "not known";
      continue;
    }
    EXPECT_GT(m.at(1990).sigma, 2 * m.at(1400).sigma);
    EXPECT_GT(m.at(-500).sigma, 3 * m.at(0).sigma);
    EXPECT_GT(m.at(7700).sigma, 3 * m.at(7200).sigma);
    EXPECT_LT(std::abs(m.at(1990).offset - w.at(1990)), 4 * m.at(1990).sigma);
  }
}

TEST(ClockModel, EventsAreCorrectedAndFlagged) {
  World w;
  w.run();
  core::EventTags e;
  e.computer_clock = true;
  e.epoch = w.log.epoch + 1000;
  e.time = {-1200, 10, 2000.5, 9000};
  e.sigma.assign(4, 0);
  e.id = {"a", "b", "c", "d"};
  e.strip.assign(4, 1);
  e.doubtful.assign(4, 0);
  ClockOptions o;
  o.convergence = Convergence::fixed;
  o.convergence_time = core::Seconds(1500);
  const ClockModel m(w.log, o);
  const CorrectedEvents c = correct(e, m, o);
  EXPECT_FALSE(c.events.computer_clock);
  EXPECT_EQ(c.events.doubtful, (std::vector<std::uint8_t>{1, 1, 0, 1}));
  EXPECT_EQ(c.before_settled, 2u);
  EXPECT_EQ(c.outside_log, 2u);
  EXPECT_NEAR(c.events.time[2], 2000.5 + w.at(3000.5), 4e-6);
  EXPECT_NEAR(c.events.sigma[2], std::hypot(m.at(3000.5).sigma, 5e-6), 1e-15);
}

TEST(ClockModel, LogsThatAreTooShortOrDisordered) {
  core::ClockData log;
  log.time = {0};
  log.offset = {1};
  EXPECT_THROW(ClockModel{log}, core::Error);
  log.time = {0, 0};
  log.offset = {1, 1};
  EXPECT_THROW(ClockModel{log}, core::Error);
  // A few records, or some without any scatter, still give a finite answer.
  for (const size_t n : {2u, 3u, 4u, 9u, 40u}) {
    core::ClockData flat;
    for (size_t i = 0; i < n; ++i) {
      flat.time.push_back(16.0 * static_cast<double>(i));
      flat.offset.push_back(1e-3);
    }
    const ClockReading r = ClockModel(flat).at(8);
    EXPECT_NEAR(r.offset, 1e-3, 1e-9) << n;
    EXPECT_TRUE(std::isfinite(r.sigma)) << n;
  }
}

}  // namespace
}  // namespace swath::trajectory
