// SPDX-License-Identifier: GPL-3.0-or-later
// Several processes do one run: the products are those of one process, in whatever order and however often the shares come.
#include "pipeline/engine/share.h"

#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <map>
#include <numeric>
#include <random>

#include "pipeline/run.h"
#include "simulate/simulate.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

TEST(Share, EveryPieceIsDoneByOnePartAndTheWorkIsEven) {
  std::mt19937 random(5);
  std::vector<double> work(97);
  for (double& w : work) w = std::exponential_distribution<double>(0.1)(random);
  const int parts = 7;
  std::vector<int> owners(work.size(), 0);
  std::vector<double> load;
  for (int part = 1; part <= parts; ++part) {
    const std::vector<bool> mine = pieces_of(work, part, parts);
    load.push_back(0.0);
    for (size_t i = 0; i < work.size(); ++i)
      if (mine[i]) ++owners[i], load.back() += work[i];
  }
  EXPECT_EQ(owners, std::vector<int>(work.size(), 1));
  // Longest work first is never more than 4/3 of the best (Graham 1969); here pieces are small beside a part.
  const double mean = std::accumulate(load.begin(), load.end(), 0.0) / parts;
  for (const double one : load) EXPECT_NEAR(one / mean, 1.0, 0.1);
}

TEST(Share, MorePartsThanPiecesLeaveSomeWithoutWork) {
  int done = 0;
  for (int part = 1; part <= 5; ++part)
    for (const bool mine : pieces_of({3.0, 1.0}, part, 5)) done += mine;
  EXPECT_EQ(done, 2);
}

TEST(Share, PartsAreReadOrRefused) {
  const Share s = read_share(3, "2/8");
  EXPECT_EQ(s.wave, 3u);
  EXPECT_EQ(s.part, 2);
  EXPECT_EQ(s.parts, 8);
  for (const char* wrong : {"", "2", "0/8", "9/8", "2/", "/8", "a/b", "2/8x", "-1/8", "2/8/3", "1/100001", "99999999999/99999999999"})
    EXPECT_THROW(read_share(0, wrong), core::Error) << wrong;
}

TEST(Share, APieceIsDoneByOneProcessAtATime) {
  const test::TemporaryFolder folder;
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const PieceLock lock(folder / "piece");
    if (write(ready[1], "x", 1) != 1) _exit(1);
    usleep(300000);
    std::ofstream(folder / "done") << "yes";
    _exit(0);  // as a kill: the lock goes with the process
  }
  char c;
  ASSERT_EQ(read(ready[0], &c, 1), 1);
  const PieceLock lock(folder / "piece");
  EXPECT_TRUE(fs::exists(folder / "done"));
  int status = 0;
  waitpid(child, &status, 0);
}

/// Two lines in tiles of 120 m, and a config with a comparison of lines, filters, terrain and contours.
class SharedRun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    simulate::Options o = simulate::preset(simulate::Scene::hills);
    o.mounting.deliver = simulate::Deliver::truth;
    simulate::run(o, folder_->path());
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static Request request(const fs::path& output) {
    Request r;
    r.config = test::source_folder() / "configs/survey_sbet.toml";
    r.survey = *folder_ / "survey.toml";
    r.output = output;
    r.sets = {"run.tile=120 m"};
    r.threads = 1;
    return r;
  }
  static Outcome share(const fs::path& output, size_t wave, int part, int parts) {
    Plan plan = make_plan(request(output));
    Progress progress(Voice::quiet);
    return run_share(plan, progress, "test", {wave, part, parts, {}});
  }
  static std::map<std::string, std::string> products(const fs::path& folder) {
    std::map<std::string, std::string> out;
    for (const auto& e : fs::recursive_directory_iterator(folder))
      if (e.is_regular_file() && e.path().filename() != "report.json")
        out[fs::relative(e.path(), folder).string()] = test::read_bytes(e.path());
    return out;
  }
  static std::string refusal(const std::function<void()>& f) {
    try {
      f();
    } catch (const core::Error& e) {
      return e.text();
    }
    return "";
  }
  static std::unique_ptr<test::TemporaryFolder> folder_;
};
std::unique_ptr<test::TemporaryFolder> SharedRun::folder_;

TEST_F(SharedRun, HasNoWaveOfAStageThatTheSurveyHasNothingFor) {
  Plan plan = make_plan(request(*folder_ / "waves"));
  const auto has_check_points = [&] {
    const std::vector<Wave> waves = waves_of(plan);
    return std::any_of(waves.begin(), waves.end(), [&](const Wave& w) { return name_of(plan, w) == "quality.points"; });
  };
  EXPECT_FALSE(has_check_points());
  io::ControlFile marks;
  marks.file = "marks.csv";
  marks.use = io::ControlUse::check;
  plan.survey.control.push_back(marks);
  EXPECT_TRUE(has_check_points());
}

TEST_F(SharedRun, HasTheProductsOfOneProcessWhateverTheOrderAndHoweverOften) {
  const test::TemporaryFolder out;
  {
    Plan plan = make_plan(request(out / "alone"));
    Progress progress(Voice::quiet);
    run(plan, progress, "test");
  }
  const size_t waves = waves_of(make_plan(request(out / "shared"))).size();
  constexpr int parts = 3;
  std::mt19937 random(11);
  for (size_t wave = 0; wave + 1 < waves; ++wave) {
    std::vector<int> order{1, 2, 3, 2};  // one of them twice
    std::shuffle(order.begin(), order.end(), random);
    for (const int part : order) share(out / "shared", wave, part, parts);
  }
  const Outcome end = share(out / "shared", waves - 1, 1, 1);
  EXPECT_EQ(products(out / "alone"), products(out / "shared"));
  EXPECT_FALSE(fs::exists(out / "shared/.swath"));
  EXPECT_GT(end.report.find("pieces_resumed")->as_int(), 10);
  const Outcome again = share(out / "shared", waves - 1, 1, 1);  // as a scheduler repeats what is slow
  EXPECT_EQ(again.code, end.code);
  EXPECT_EQ(again.report.find("pieces_resumed")->as_int(), end.report.find("pieces_resumed")->as_int());
  // The report of this plan says nothing of another's tasks.
  Request other = request(out / "shared");
  other.sets.push_back("dtm.cell=2 m");
  Plan plan = make_plan(other);
  Progress progress(Voice::quiet);
  const std::string fault = refusal([&] { run_share(plan, progress, "test", {waves - 1, 1, 1, {}}); });
  EXPECT_NE(fault.find("there is no work folder"), std::string::npos) << fault;
}

TEST_F(SharedRun, AWaveBeforeItsTurnIsRefusedAndNothingIsLost) {
  const test::TemporaryFolder out;
  EXPECT_NE(refusal([&] { share(out / "out", 1, 1, 2); }).find("there is no work folder"), std::string::npos);
  share(out / "out", 0, 1, 1);
  share(out / "out", 1, 1, 2);
  const std::string early = refusal([&] { share(out / "out", 2, 1, 2); });
  EXPECT_NE(early.find("is missing"), std::string::npos) << early;
  EXPECT_NE(early.find("do all parts of wave 1 (strips) first"), std::string::npos) << early;
  share(out / "out", 1, 2, 2);
  EXPECT_EQ(refusal([&] { share(out / "out", 2, 1, 2); }), "");
  const std::string tiles = refusal([&] { share(out / "out", 3, 1, 2); });
  EXPECT_NE(tiles.find("tiles of"), std::string::npos) << tiles;
  EXPECT_NE(refusal([&] { share(out / "out", 99, 1, 2); }).find("there is no wave 99"), std::string::npos);
}

TEST_F(SharedRun, AnotherPlanInTheSameFolderIsRefused) {
  const test::TemporaryFolder out;
  share(out / "out", 0, 1, 1);
  share(out / "out", 1, 1, 1);
  Request other = request(out / "out");
  other.sets.push_back("run.tile=110 m");
  Plan plan = make_plan(other);
  Progress progress(Voice::quiet);
  const std::string fault = refusal([&] { run_share(plan, progress, "test", {0, 1, 1, {}}); });
  EXPECT_NE(fault.find("it holds work of another plan"), std::string::npos) << fault;
  const std::string end = refusal([&] { run_share(plan, progress, "test", {waves_of(plan).size() - 1, 1, 1, {}}); });
  EXPECT_NE(end.find("it holds work of another plan"), std::string::npos) << end;
  EXPECT_EQ(refusal([&] { share(out / "out", 2, 1, 1); }), "");  // the first plan goes on
}

TEST_F(SharedRun, ATaskOfAChangedPlanIsRefused) {
  const test::TemporaryFolder out;
  Plan plan = make_plan(request(out / "out"));
  Progress progress(Voice::quiet);
  for (const size_t wave : {size_t{0}, waves_of(plan).size() - 1}) {
    fs::create_directories(out / "out/.swath");
    EXPECT_NE(refusal([&] {
                run_share(plan, progress, "test", {wave, 1, 1, "of another plan"});
              }).find("have changed"),
              std::string::npos)
        << wave;
  }
}

}  // namespace
}  // namespace swath::pipeline
