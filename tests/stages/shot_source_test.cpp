// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/shot_source.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace swath::stages {
namespace {

/// Gives each strip's number of shots in batches of three; the last shot of strip `bad` cannot be read.
class CountingReader : public StripReader {
 public:
  CountingReader(const Strip& strip, bool fails) : strip_(strip), fails_(fails) {}
  bool next(StripBatch& batch, size_t, core::Tally& tally) override {
    if (at_ >= strip_.records) {
      if (fails_) throw core::Error("the record is cut short", strip_.name, "");
      tally.count("told at the end");
      return false;
    }
    for (size_t k = 0; k < 3 && at_ < strip_.records; ++k) batch.shots.time.push_back(static_cast<double>(strip_.line * 100 + at_++));
    return true;
  }

 private:
  Strip strip_;
  bool fails_;
  std::uint64_t at_ = 0;
};

class CountingSource : public Stage {
 public:
  explicit CountingSource(size_t bad = 99) : bad_(bad) {}
  const Info& info() const override {
    static const Info info{"source", "", {Grain::strip}, {}, {}, {}, {Product::shots}};
    return info;
  }
  void visit(core::Visitor&) override {}
  std::unique_ptr<StripReader> open(const Context&, const Strip& s) const override {
    return std::make_unique<CountingReader>(s, s.index == bad_);
  }

 private:
  size_t bad_;
};

struct Read {
  std::vector<int> line;
  std::vector<double> time;
};

Read read_all(const georef::ShotStream& stream) {
  Read out;
  stream([&](int line, const core::Shots& shots) {
    out.line.push_back(line);
    out.time.insert(out.time.end(), shots.time.begin(), shots.time.end());
  });
  return out;
}

Strip strip(size_t index, int line, std::uint64_t records) { return {0, index, line, "line " + std::to_string(line), records}; }

TEST(ShotSource, ReadsStripsInTheirOrderAsOftenAsAsked) {
  const io::Survey survey;
  const CountingSource source;
  Context context{survey};
  context.source = &source;
  context.strips = {strip(0, 2, 4), strip(1, 1, 0), strip(2, 7, 3)};
  const georef::ShotStream stream = stream_shots(context);
  for (int round = 0; round < 2; ++round) {
    const Read read = read_all(stream);
    EXPECT_EQ(read.line, (std::vector<int>{2, 2, 7}));
    EXPECT_EQ(read.time, (std::vector<double>{200, 201, 202, 203, 700, 701, 702}));
  }
}

TEST(ShotSource, AFaultOfTheReaderComesThrough) {
  const io::Survey survey;
  const CountingSource source(1);
  Context context{survey};
  context.source = &source;
  context.strips = {strip(0, 2, 4), strip(1, 1, 2)};
  EXPECT_THROW(read_all(stream_shots(context)), core::Error);
}

TEST(ShotSource, APlanWithoutShotsIsRefused) {
  const io::Survey survey;
  const Context context{survey};
  EXPECT_THROW(stream_shots(context), core::Error);
}

}  // namespace
}  // namespace swath::stages
