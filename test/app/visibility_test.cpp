// SPDX-License-Identifier: BSD-3-Clause
// Stage 2 by the options --visibility and --executor of `check` and `bench robot`.
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "run_program.h"
#include "visibility_options.h"

namespace fcl_artic::app {
namespace visibility_test {
namespace {

using Json = nlohmann::json;

class VisibilityProgram : public ProgramTest {
 protected:
  /// The arm goes past the ball, or up to shortly before it.
  Json check(const std::string& options, bool contact) {
    const Outcome run =
        this->run("check --json " + armAndBall() + " --from 0,0 --to " + (contact ? "90deg,0 " : "44deg,0 ") + options);
    EXPECT_EQ(run.status, contact ? 1 : 0) << options << "\n" << run.err << run.out;
    return Json::parse(run.out);
  }
};

TEST_F(VisibilityProgram, OffIsTheDefaultAndSaysNothing) {
  EXPECT_TRUE(check("", true).at("visibility").is_null());
  EXPECT_TRUE(check("--visibility off", true).at("visibility").is_null());
}

TEST_F(VisibilityProgram, JsonTellsWhetherItWasUsedAndByWhom) {
  const Json off = check("", true), on = check("--visibility on", true);
  EXPECT_EQ(on.at("visibility").at("mode"), "on");
  EXPECT_EQ(on.at("visibility").at("used"), true);
  EXPECT_EQ(on.at("visibility").at("executor"), "cpu");
  EXPECT_TRUE(on.at("visibility").at("fallback").is_null());
  EXPECT_GE(on.at("visibility").at("pairs"), 1);
  for (const char* key : {"t_lower", "t_upper", "contacts"}) EXPECT_EQ(on.at(key), off.at(key)) << key;
  // Nothing is left for it here: the arm and the ball are far apart.
  const Outcome far = this->run("check --json --visibility on " + armAndBall() + " --from -1,0 --to -0.9,0");
  EXPECT_EQ(Json::parse(far.out).at("visibility").at("used"), false) << far.err;
  EXPECT_TRUE(Json::parse(far.out).at("visibility").at("executor").is_null());
}

TEST_F(VisibilityProgram, TextHasALine) {
  const Outcome run = this->run("check --visibility on " + armAndBall() + " --from 0,0 --to 90deg,0");
  EXPECT_NE(run.out.find("stage 2   executor cpu: 1 pair seen"), std::string::npos) << run.out;
  EXPECT_EQ(this->run("check " + armAndBall() + " --from 0,0 --to 90deg,0").out.find("stage 2"), std::string::npos);
}

/// Each that was built in does it; or cpu does, and the answer says why.
TEST_F(VisibilityProgram, ExecutorsThatWereBuiltIn) {
  for (const std::string& name : executorNames()) {
    const Json answer = check("--visibility on --executor " + name, false).at("visibility");
    if (answer.at("executor") != name) {
      EXPECT_EQ(answer.at("executor"), "cpu");
      EXPECT_FALSE(answer.at("fallback").is_null()) << name;
    }
  }
}

TEST_F(VisibilityProgram, AnExecutorThatIsNotThereIsAnError) {
  try {
    (void)makeCuller("vulkan");
    ADD_FAILURE() << "made";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("--executor vulkan: this program was built without it; it has cpu"),
              std::string::npos)
        << e.what();
  }
  for (const std::string verb : {"check --from 0,0 --to 1,0", "bench robot"}) {
    const std::string arguments = verb + " " + armAndBall();
    EXPECT_EQ(this->run(arguments + " --executor vulkan").status, 2) << verb;
    EXPECT_EQ(this->run(arguments + " --visibility sometimes").status, 2) << verb;
    for (const char* name : {"cpu", "osmesa", "egl"}) {
      const auto& built = executorNames();
      if (std::find(built.begin(), built.end(), name) != built.end()) continue;
      const Outcome run = this->run(arguments + " --executor " + name);
      EXPECT_EQ(run.status, 2) << verb << name;
      EXPECT_NE(run.err.find("was built without it"), std::string::npos) << run.err;
    }
  }
}

TEST_F(VisibilityProgram, LinesHaveItEach) {
  const std::string lines = write("lines", R"({"from": [0, 0], "to": ["90deg", 0]})"
                                           "\n"
                                           R"({"from": [-1, 0], "to": [-0.9, 0]})"
                                           "\n");
  const Outcome run = this->run("check --visibility on " + armAndBall() + " --lines " + lines);
  std::istringstream answers(run.out);
  std::string first, second;
  std::getline(answers, first);
  std::getline(answers, second);
  EXPECT_EQ(Json::parse(first).at("visibility").at("used"), true);
  EXPECT_EQ(Json::parse(second).at("visibility").at("used"), false);
  const Outcome off = this->run("check " + armAndBall() + " --lines " + lines);
  EXPECT_EQ(off.out.find("visibility"), std::string::npos);
}

TEST_F(VisibilityProgram, BenchRobotTellsWhatItDid) {
  const std::string bench = "bench robot --json --no-fcl --motions 20 --passes 1 --angle 20 " + armAndBall();
  const Outcome run = this->run(bench + " --visibility on");
  ASSERT_EQ(run.status, 0) << run.err;
  const Json told = Json::parse(run.out).at("visibility");
  EXPECT_EQ(told.at("mode"), "on");
  EXPECT_EQ(told.at("executor"), "cpu");
  EXPECT_GT(told.at("pairs"), 0);
  const Outcome off = this->run(bench);
  EXPECT_TRUE(Json::parse(off.out).at("visibility").is_null()) << off.err;
}

}  // namespace
}  // namespace visibility_test
}  // namespace fcl_artic::app
