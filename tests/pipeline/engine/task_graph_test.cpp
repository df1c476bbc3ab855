// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/task_graph.h"

#include <algorithm>
#include <set>

#include "core/config/result_visitors.h"
#include "io/records/record_count.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "pipeline/expected_time.h"
#include "simulate/simulate.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

class Tasks : public testing::Test {
 protected:
  void SetUp() override {
    simulate::Options o = simulate::preset(simulate::Scene::hills);
    o.mounting.deliver = simulate::Deliver::truth;
    simulate::run(o, folder_ / "survey");
    request_.config = test::source_folder() / "configs/survey_sbet.toml";
    request_.survey = folder_ / "survey/survey.toml";
    request_.output = folder_ / "out";
    request_.sets = {"dtm.cell=2 m"};
  }
  fs::path written(const TaskGraph& graph) const {
    io::write_text_file(folder_ / "tasks.json", io::to_json(core::reported(graph)));
    return folder_ / "tasks.json";
  }
  std::string refusal(const fs::path& plan, const std::string& id) const {
    try {
      planned_task(plan, id);
    } catch (const core::Error& e) {
      return e.text();
    }
    return "";
  }
  test::TemporaryFolder folder_;
  Request request_;
};

TEST_F(Tasks, NeedTasksThatComeBeforeThem) {
  const TaskGraph graph = task_graph(request_, 4);
  std::set<std::string> before;
  for (const Task& t : graph.tasks) {
    for (const std::string& need : t.needs) EXPECT_TRUE(before.contains(need)) << t.id << " needs " << need;
    EXPECT_TRUE(before.insert(t.id).second) << t.id;
    EXPECT_EQ(t.needs.empty(), t.wave == 0) << t.id;
    EXPECT_EQ(t.parts, t.grain == "strip" || t.grain == "tile" ? 4u : 1u) << t.id;
  }
  EXPECT_EQ(graph.tasks.front().id, "0-survey");
  EXPECT_EQ(graph.tasks[1].id, "1-strips.1");
  EXPECT_EQ(graph.tasks.back().grain, "finish");
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  EXPECT_EQ(graph.returns, io::stated_records(folder_ / "survey/laser.npy")) << "as the header states them";
  EXPECT_GT(graph.returns, 1000u);
  EXPECT_EQ(graph.returns_estimated, 0u);
  EXPECT_GT(graph.seconds, graph.critical_seconds);
}

TEST_F(Tasks, OfATrajectoryTakeTimeWithTheRecordsOfTheImu) {
  request_.config = test::source_folder() / "configs/trajectory.toml";
  request_.sets = {};
  const std::string imu = test::read_bytes(folder_ / "survey/imu.csv");
  const auto records = static_cast<double>(std::count(imu.begin(), imu.end(), '\n') - 1);
  const double expected = records * expected_seconds_of_imu_record("trajectory.ins_gnss");
  EXPECT_NEAR(task_graph(request_, 1).tasks.front().seconds / expected, 1.0, 0.02);
  test::write_bytes(folder_ / "survey/imu.csv", imu.substr(0, imu.size() / 2));
  EXPECT_NEAR(task_graph(request_, 1).tasks.front().seconds / expected, 0.5, 0.02);
}

TEST_F(Tasks, AreReadBackWithWhatIsKnownOfTheInputs) {
  const TaskGraph graph = task_graph(request_, 4);
  const PlannedTask task = planned_task(written(graph), "1-strips.3");
  EXPECT_EQ(task.share.wave, 1u);
  EXPECT_EQ(task.share.part, 3);
  EXPECT_EQ(task.share.parts, 4);
  EXPECT_EQ(task.share.fingerprint, graph.fingerprint);
  EXPECT_EQ(task.request.sets, request_.sets);
  EXPECT_EQ(task.inputs.size(), graph.inputs.size());
}

TEST(TaskText, NamesReturnsThatAreEstimated) {
  TaskGraph graph;
  graph.returns = 20000;
  EXPECT_NE(task_text(graph).find("20.0 k returns of "), std::string::npos) << task_text(graph);
  graph.returns_estimated = 5;
  EXPECT_NE(task_text(graph).find("20.0 k returns (estimated: "), std::string::npos) << task_text(graph);
}

TEST_F(Tasks, OfAnotherPlanOrAChangedSurveyAreRefused) {
  const fs::path plan = written(task_graph(request_, 4));
  EXPECT_NE(refusal(plan, "1-strip.3").find("did you mean '1-strips.3'?"), std::string::npos);
  EXPECT_NE(refusal(request_.config, "0-survey").find("it is a pipeline, not a list of tasks"), std::string::npos);
  fs::path changed;
  for (const auto& e : fs::directory_iterator(folder_ / "survey"))
    if (e.path().filename().string().starts_with("laser")) changed = e.path();
  ASSERT_FALSE(changed.empty());
  fs::last_write_time(changed, fs::last_write_time(changed) + std::chrono::seconds(2));
  EXPECT_NE(refusal(plan, "0-survey").find("it has changed since the tasks were listed"), std::string::npos);
  fs::remove(changed);
  EXPECT_NE(refusal(plan, "0-survey").find("it is not there"), std::string::npos);
}

TEST_F(Tasks, BecomeJobArraysOfWhichEachWaitsForTheOneBefore) {
  const TaskGraph graph = task_graph(request_, 4);
  const std::string script = slurm_script(graph, folder_ / "it's a plan.json", "/opt/swath");
  EXPECT_NE(script.find("--array=1-4"), std::string::npos);
  EXPECT_NE(script.find("--dependency=afterok:\"$job0\""), std::string::npos);
  EXPECT_NE(script.find("1-strips."), std::string::npos);
  EXPECT_EQ(script.find("0-survey."), std::string::npos);
  io::write_text_file(folder_ / "jobs.sh", script);
  EXPECT_EQ(std::system(("sh -n '" + (folder_ / "jobs.sh").string() + "'").c_str()), 0);
}

TEST_F(Tasks, WithoutAPartAreRefused) {
  EXPECT_THROW(task_graph(request_, 0), core::Error);
  request_.survey.clear();
  EXPECT_THROW(task_graph(request_, 4), core::Error);
}

}  // namespace
}  // namespace swath::pipeline
