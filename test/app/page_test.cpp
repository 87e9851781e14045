// SPDX-License-Identifier: BSD-3-Clause
//
// Answers as pages: what is in them, that they load nothing, and that a browser shows them.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <regex>
#include <set>

#include <fcl/geometry/shape/sphere.h>
#include <nlohmann/json.hpp>

#include "fcl_artic/point_cloud.h"
#include "fcl_artic/urdf/urdf.h"
#include "report/page.h"
#include "run_program.h"

namespace page_test {

namespace {

using namespace fcl_artic;
using namespace fcl_artic::app;
using Json = nlohmann::json;

/// The text between two others, the first time.
std::string between(const std::string& text, const std::string& open, const std::string& close) {
  const std::size_t begin = text.find(open);
  if (begin == std::string::npos) return {};
  const std::size_t from = begin + open.size();
  return text.substr(from, text.find(close, from) - from);
}
std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}
Json answerOf(const std::string& page) {
  return Json::parse(between(page, "<script type=\"application/json\" id=\"answer\">", "</script>"));
}
Json motionOf(const std::string& page) {
  return Json::parse(between(page, "<script type=\"application/json\" id=\"motion\">", "</script>"));
}

/// Every tag that is opened is closed in its turn; scripts and styles are not looked into.
void expectWellFormed(const std::string& page) {
  static const std::set<std::string> kEmpty{"meta", "input", "br", "link", "img"};
  std::string rest = std::regex_replace(page, std::regex("<!--[^]*?-->"), "");
  for (const std::string tag : {"script", "style"}) {
    std::string kept;
    for (std::size_t at = 0;;) {
      const std::size_t open = rest.find("<" + tag, at);
      kept += rest.substr(at, open - at);
      if (open == std::string::npos) break;
      at = rest.find("</" + tag + ">", open);
      ASSERT_NE(at, std::string::npos) << tag;
      at += tag.size() + 3;
    }
    rest = kept;
  }
  std::vector<std::string> open;
  for (std::size_t at = rest.find('<'); at != std::string::npos; at = rest.find('<', at + 1)) {
    const std::size_t end = rest.find('>', at);
    ASSERT_NE(end, std::string::npos);
    const std::string tag = rest.substr(at + 1, end - at - 1);
    if (tag[0] == '!') continue;
    const std::string name = tag.substr(tag[0] == '/', tag.find_first_of(" \n") - (tag[0] == '/'));
    if (tag[0] == '/') {
      ASSERT_FALSE(open.empty()) << tag;
      ASSERT_EQ(open.back(), name);
      open.pop_back();
    } else if (!kEmpty.count(name)) {
      open.push_back(name);
    }
  }
  EXPECT_TRUE(open.empty());
}

void expectSelfContained(const std::string& page) {
  EXPECT_NE(page.find("content=\"default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'\""),
            std::string::npos);
  for (const char* load :
       {" src=", " href=", "@import", "url(", "<link", "<img", "fetch(", "XMLHttpRequest", "import("}) {
    EXPECT_EQ(page.find(load), std::string::npos) << load;
  }
  // The name of SVG's elements is no address that is loaded.
  EXPECT_EQ(countOf(page, "http://") + countOf(page, "https://"), countOf(page, "'http://www.w3.org/2000/svg'"));
}

TEST_F(ProgramTest, PageOfAContactHasTheAnswer) {
  const std::string file = path("hit.html"), query = "check " + armAndBall() + " --from 0,0 --to 90deg,0 ";
  const Outcome run = this->run(query + "--html " + file);
  ASSERT_EQ(run.status, 1) << run.err;
  const std::string page = read(file);
  expectWellFormed(page);
  expectSelfContained(page);
  // The same answer as --json has, but for times that were measured.
  const Json wanted = Json::parse(this->run(query + "--json").out), answer = answerOf(page);
  for (const char* key : {"status", "t_lower", "t_upper", "certain", "contacts", "poses", "request", "q_at_t_lower"}) {
    EXPECT_EQ(answer.at(key), wanted.at(key)) << key;
  }
  EXPECT_NE(page.find("<title>first contact at t = "), std::string::npos);
  EXPECT_NE(between(page, "<pre>", "</pre>").find("CONTACT: first contact at t = "), std::string::npos);

  const Json motion = motionOf(page);
  std::set<std::string> names;
  for (const Json& body : motion.at("bodies")) names.insert(body.at("name"));
  EXPECT_EQ(names, (std::set<std::string>{"arm", "slide", "ball"}));
  // Poses are told at the very times of the bracket.
  const std::vector<double> times = motion.at("times");
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  for (const double t : {0.0, 1.0, answer.at("t_lower").get<double>(), answer.at("t_upper").get<double>()}) {
    EXPECT_TRUE(std::binary_search(times.begin(), times.end(), t)) << t;
  }
}

TEST_F(ProgramTest, PageOfAWitnessHasWhereTheTolerancesLetBodiesTouch) {
  const std::string file = path("witness.html"),
                    way = "check " + armAndBall() + " --from 0,0 --to 40deg,0 --html " + file;
  // The arm turns about the world's z axis. At its goal it is 0.055 m from the ball.
  for (const bool base : {true, false}) {
    ASSERT_EQ(this->run(way + (base ? " --base-tolerance 100mm" : " --tolerance ball=100mm")).status, 1);
    const Json motion = motionOf(read(file)), contact = answerOf(read(file)).at("contacts").at(0);
    ASSERT_TRUE(contact.at("certain"));
    EXPECT_EQ(contact.at("base_deviation").is_null(), !base);
    EXPECT_EQ(contact.at("deviation2").is_null(), base);
    std::set<std::string> names;
    for (const Json& placed : motion.at("witnesses").at(0)) {
      const Json& body = motion.at("bodies").at(placed.at("body").get<std::size_t>());
      names.insert(body.at("name"));
      const auto at = [](const Json& numbers) { return Eigen::Vector3d(numbers[0], numbers[1], numbers[2]); };
      Eigen::Vector3d expected = at(body.at("pose"));
      if (body.at("name") == "arm") {
        expected = Eigen::AngleAxisd(contact.at("q_witness").at("hinge"), Eigen::Vector3d::UnitZ()) * expected;
        if (base) expected += at(contact.at("base_deviation").at("position"));
        expected -= at(motion.at("center"));
      } else if (body.at("name") == "ball") {
        expected += at(contact.at("deviation2").at("position"));
      } else {
        continue;
      }
      EXPECT_LT((at(placed.at("pose")) - expected).norm(), 1e-12) << body.at("name");
    }
    EXPECT_EQ(names.count("arm"), 1u);
    EXPECT_EQ(names.count("ball"), base ? 0u : 1u);
  }
  ASSERT_EQ(this->run("check " + armAndBall() + " --from 0,0 --to 90deg,0 --html " + file).status, 1);
  EXPECT_TRUE(motionOf(read(file)).at("witnesses").at(0).is_null()) << "without tolerances there is none";
}

TEST_F(ProgramTest, PageOfAFreeMotionHasNoContact) {
  const std::string file = path("free.html");
  const Outcome run = this->run("check " + armAndBall() + " --from 0,0 --to 40deg,0 --html " + file);
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string page = read(file);
  expectWellFormed(page);
  expectSelfContained(page);
  EXPECT_EQ(answerOf(page).at("status"), "free");
  EXPECT_TRUE(answerOf(page).at("contacts").empty());
}

TEST_F(ProgramTest, PageOfATrajectoryIsInItsOwnTime) {
  const std::string csv = write("way.csv", "time,hinge\n10,0\n12,0.3\n14,1.5\n"), file = path("way.html");
  const Outcome run = this->run("check " + armAndBall() + " --state rail=0 --trajectory " + csv + " --html " + file);
  ASSERT_EQ(run.status, 1) << run.err;
  const std::string page = read(file);
  const Json answer = answerOf(page), motion = motionOf(page);
  EXPECT_GT(answer.at("t_lower"), 12);
  EXPECT_EQ(motion.at("times").front(), 10);
  EXPECT_EQ(motion.at("times").back(), 14);
  EXPECT_EQ(motion.at("distances").at("times").front(), 10);
  EXPECT_EQ(motion.at("distances").at("times").back(), 14);
  // A pair counts once, whatever the number of pieces that are asked.
  EXPECT_EQ(motion.at("pieces"), 2);
  const Outcome straight = this->run("check " + armAndBall() + " --from 0,0 --to 0.3,0 --json");
  EXPECT_EQ(motion.at("distances").at("pairs"), Json::parse(straight.out).at("statistics").at("pairs"));
  EXPECT_EQ(answer.at("statistics").at("pairs"), 2 * motion.at("distances").at("pairs").get<int>());
}

// The page's own functions, run by node where that is found.
TEST_F(ProgramTest, NumbersOfAPageArePlain) {
  if (std::system("command -v node >/dev/null 2>&1") != 0) GTEST_SKIP() << "node is not found";
  const std::string file = path("hit.html");
  ASSERT_EQ(this->run("check " + armAndBall() + " --from 0,0 --to 90deg,0 --html " + file).status, 1);
  const std::string page = read(file);
  const auto functionOf = [&](const std::string& begin, const std::string& end) {
    const std::string body = between(page, begin, end);
    EXPECT_NE(body, "") << begin;
    return begin + body + end;
  };
  const std::string script = write(
      "numbers.js", functionOf("const fixed = ", ";\n") + functionOf("const shown = ", ";\n") +
                        functionOf("function vectorText(", "\n}\n") +
                        "console.log([fixed(-1e-9, 4), fixed(-0.25, 1), fixed(0, 4), vectorText([0, -1, 1.2e-17]), "
                        "vectorText([0.5, -3e-5, -2]), vectorText([0, 0, 0])].join('|'));\n");
  ASSERT_EQ(std::system(("node " + script + " >" + path("out")).c_str()), 0);
  EXPECT_EQ(read(path("out")), "0.0000|-0.3|0.0000|(0, -1, 0)|(0.5, -0.00003, -2)|(0, 0, 0)\n");
  for (const char* unit : {"vectorText(c.point)} m", "vectorText(c.nearest1)} m", "m per unit of t"})
    EXPECT_NE(page.find(unit), std::string::npos) << unit;
}

TEST_F(ProgramTest, NamesInAPageAreTextOnly) {
  const std::string evil = "&lt;/script>&lt;img onerror='alert(1)'>&amp;amp;";
  const std::string scene = write("evil.urdf", "<robot name=\"evil\"><link name=\"" + evil +
                                                   "\"><collision><origin xyz=\"0.3 0.52 0\"/><geometry><sphere "
                                                   "radius=\"0.1\"/></geometry></collision></link></robot>");
  const std::string file = path("evil.html");
  const Outcome run =
      this->run("check --robot " + arm() + " --scene " + scene + " --from 0,0 --to 90deg,0 --html " + file);
  ASSERT_EQ(run.status, 1) << run.err;
  const std::string page = read(file);
  expectWellFormed(page);
  EXPECT_EQ(countOf(page, "</script"), 3u);
  EXPECT_EQ(countOf(page, "<img"), 0u);
  EXPECT_EQ(answerOf(page).at("contacts").at(0).at("body2").at("name"), "</script><img onerror='alert(1)'>&amp;");
}

TEST_F(ProgramTest, UnwritablePageIsAnError) {
  const Outcome run = this->run("check --robot " + arm() + " --from 0,0 --to 1,0 --html /nowhere/x.html");
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("/nowhere/x.html"), std::string::npos) << run.err;
}

/// For a configuration: the distance of the arm's box from the ball (run_program.h), in closed form in the arm's frame.
double distanceOfBall(double hinge) {
  const double angle = M_PI / 3 - hinge, x = 0.6 * std::cos(angle), y = 0.6 * std::sin(angle);
  const double dx = std::max({0.0, -x, x - 1}), dy = std::max(0.0, std::abs(y) - 0.05);
  return std::max(0.0, std::hypot(dx, dy) - 0.1);
}

TEST_F(ProgramTest, DistancesHoldOverTheirSteps) {
  const Robot robot = loadUrdf(arm());
  const Scene scene = loadScene(ball());
  ArticulatedCollisionManager manager(robot.tree);
  robot.addTo(manager);
  scene.addTo(manager);
  manager.setup();
  const auto q = [](double hinge) { return Eigen::Vector2d(hinge, 0); };
  Eigen::MatrixXd cubic(2, 4);
  cubic << 0.2, 0, 3, -2, 0, 0, 0, 0;
  const RobotMotion motions[] = {
      JointMotion::linear(*robot.tree, q(0.2), q(1.9)),
      JointMotion::polynomial(*robot.tree, cubic),
      JointMotion::tangentHalfAngle(*robot.tree, q(-0.5), q(1.5)),
      JointTrajectory::linear(*robot.tree, {5, 5.1, 7, 7.001, 9}, {q(0), q(0.5), q(0.3), q(0.3), q(1.2)}),
  };
  DistanceOptions options;
  options.links = false;
  int touching = 0, apart = 0;
  for (const RobotMotion& motion : motions) {
    const Distances distances = measureDistances(manager, motion, options);
    ASSERT_EQ(distances.missing, "");
    ASSERT_EQ(distances.steps.size(), 100u);
    const auto [begin, end] = timeOf(motion);
    EXPECT_EQ(distances.steps.front().begin, begin);
    EXPECT_EQ(distances.steps.back().end, end);
    double last = begin;
    for (const DistanceStep& step : distances.steps) {
      EXPECT_EQ(step.begin, last);
      last = step.end;
      double least = 1e9;
      for (int i = 0; i <= 50; ++i) {
        const double t = step.begin + (step.end - step.begin) * i / 50;
        least = std::min(least, distanceOfBall(configurationAt(motion, t)[0]));
      }
      const Clearance& c = step.obstacles;
      ASSERT_TRUE(c.within_tolerance);
      EXPECT_LE(c.lower, least + 1e-12);
      // Where the samples miss the least distance, they are above it by what the arm moves between two of them.
      EXPECT_GE(c.upper, least - 2e-3);
      EXPECT_LE(c.upper - c.lower, std::max(0.05 * c.upper, 1e-3) * (1 + 1e-9));
      (c.upper == 0 ? touching : apart) += 1;
      if (c.upper > 0) {
        EXPECT_EQ(c.body2.name, "ball");
        EXPECT_LE(distanceOfBall(configurationAt(motion, c.time)[0]), c.upper + 1e-12);
      }
    }
  }
  EXPECT_GT(touching, 20);
  EXPECT_GT(apart, 100);
}

TEST_F(ProgramTest, MeasuringDistancesCanBeStopped) {
  const Robot robot = loadUrdf(arm());
  ArticulatedCollisionManager manager(robot.tree);
  robot.addTo(manager);
  manager.setup();
  DistanceOptions options;
  options.progress = [](double) { return false; };
  const Distances distances = measureDistances(
      manager, JointMotion::linear(*robot.tree, Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0)), options);
  EXPECT_NE(distances.missing, "");
  EXPECT_TRUE(distances.steps.empty());
}

TEST(PartOfMotion, IsTheMotionOverThatTime) {
  KinematicTree tree("free body");
  for (const char* link : {"root", "body", "arm"}) tree.addLink(link);
  Joint base;
  base.name = "base";
  base.type = JointType::floating;
  base.parent = "root";
  base.child = "body";
  tree.addJoint(base);
  tree.addJoint(Joint::revolute("hinge", "body", "arm", Eigen::Vector3d::UnitZ()));
  Eigen::VectorXd q0(8), q1(8);
  q0 << 0, 1, 2, 0, 0, 0, 1, -1;
  q1 << 1, 1, -2, 0.6, 0, 0.8, 0, 2;
  const auto expectSame = [&](const JointMotion& whole) {
    const double a = 0.3, b = 0.45;
    const JointMotion part = partOf(tree, whole, a, b);
    for (const double s : {0.0, 0.2, 0.5, 1.0}) {
      EXPECT_LT((part.configuration(s) - whole.configuration(a + s * (b - a))).norm(), 1e-12) << s;
    }
  };
  expectSame(JointMotion::linear(tree, q0, q1));
  expectSame(JointMotion::tangentHalfAngle(tree, q0, q1));
  Eigen::MatrixXd quintic = Eigen::MatrixXd::Zero(8, 6);
  quintic.col(0) = q0;
  quintic.row(7) << -1, 0.5, 2, -3, 1, 0.25;
  quintic.block(3, 1, 3, 1) << 0.3, 0.4, -0.5;
  expectSame(JointMotion::polynomial(tree, quintic));
  quintic(3, 2) = 0.1;  // the axis of the rotation turns
  EXPECT_THROW(partOf(tree, JointMotion::polynomial(tree, quintic), 0.3, 0.45), std::invalid_argument);
}

TEST_F(ProgramTest, APageSaysWhatItLeavesOut) {
  const Robot robot = loadUrdf(arm());
  const CertifiedRequest request;
  CertifiedResult result;
  result.status = Status::free;
  const std::vector<std::string> notes;
  const Report report{*robot.tree, request, result, notes, [](double) { return Eigen::Vector2d(0, 0); }};
  const std::size_t count = 500001;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < count; ++i) points.emplace_back(1e-5 * static_cast<double>(i), 0, 0);
  std::vector<PageBody> bodies = linksOf(*robot.tree, robot.geometry);
  bodies.push_back(
      {"cloud", "obstacle", -1, Eigen::Isometry3d::Identity(), std::make_shared<PointCloud>(points, 0.01), {}});
  const auto two = std::make_shared<fcl::Sphered>(0.1);  // one shape, two bodies
  for (const char* name : {"one", "two"})
    bodies.push_back({name, "obstacle", -1, Eigen::Isometry3d::Identity(), two, {}});
  const Json motion = motionOf(htmlPage(report, bodies, {"they were not wanted", 1, {}}));
  const Json& cloud = motion.at("shapes").at(motion.at("bodies").at(bodies.size() - 3).at("shape").get<std::size_t>());
  EXPECT_EQ(cloud.at("count"), count);
  EXPECT_EQ(cloud.at("every"), 2);
  EXPECT_EQ(cloud.at("balls").get<std::string>().size(), (count + 1) / 2 * 16 / 3 * 4 + 4);  // 16 bytes a point
  EXPECT_EQ(motion.at("shapes").size(), robot.geometry.size() + 2);
  EXPECT_EQ(motion.at("distances").at("missing"), "they were not wanted");
}

/// Chromium, without a window; where it is missing these tests are skipped.
class PageInBrowser : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    if (std::system("command -v chromium >/dev/null 2>&1") != 0) GTEST_SKIP() << "chromium is not found";
  }
  /// The output of chromium, with the page drawn by software.
  std::string browse(const std::string& page, const std::string& options) const {
    const std::string command =
        "timeout 200 chromium --headless=old --no-sandbox --use-angle=swiftshader "
        "--enable-unsafe-swiftshader --hide-scrollbars --window-size=900,700 "
        "--virtual-time-budget=5000 --user-data-dir=" +
        path("profile") + " " + options + " 'file://" + page + "' >" + path("out") + " 2>" + path("err");
    EXPECT_EQ(std::system(command.c_str()), 0) << read(path("err"));
    return read(path("out"));
  }
};

TEST_F(PageInBrowser, DrawsTheMotionAndTellsTheAnswer) {
  const std::string file = path("hit.html");
  ASSERT_EQ(this->run("check " + armAndBall() + " --from 0,0 --to 90deg,0 --html " + file).status, 1);
  const std::string page = browse(file + "#theme=dark&t=0.25", "--dump-dom");
  const std::string html = between(page, "<html", ">");
  EXPECT_EQ(between(html, "data-ready=\"", "\""), "drawn") << html;
  EXPECT_EQ(between(html, "data-theme=\"", "\""), "dark") << html;
  EXPECT_GT(std::atoi(between(html, "data-drawn-pixels=\"", "\"").c_str()), 5000) << html;
  EXPECT_EQ(between(page, "<output id=\"clock\" for=\"time\">", "<"), "t = 0.25");
  const std::string contacts = between(page, "<div id=\"contacts\">", "<details");
  EXPECT_NE(contacts.find("<span class=\"one\">arm</span>"), std::string::npos) << contacts;
  EXPECT_NE(contacts.find("<span class=\"two\">ball</span>"), std::string::npos) << contacts;
  // At t = 0.25 the hinge is at 22.5 degrees: of its two cells the second.
  EXPECT_NE(between(page, "<div id=\"joints\">", "</div>").find("22.5°"), std::string::npos);
  EXPECT_NE(between(page, "<figcaption id=\"reading\"", "</figcaption>").find("arm – ball ≤ "), std::string::npos);
}

TEST_F(PageInBrowser, DrawsTheWitnessAndNamesItInTheLegend) {
  const std::string file = path("witness.html"), way = "check " + armAndBall() + " --from 0,0 --html " + file;
  ASSERT_EQ(this->run(way + " --to 40deg,0 --base-tolerance 100mm").status, 1);
  std::string page = browse(file, "--dump-dom");
  EXPECT_GT(std::atoi(between(page, "data-witness-pixels=\"", "\"").c_str()), 200);
  EXPECT_NE(between(page, "<p id=\"legend\">", "</p>").find("your robot may touch here"), std::string::npos);
  ASSERT_EQ(this->run(way + " --to 90deg,0").status, 1);
  page = browse(file, "--dump-dom");
  EXPECT_EQ(between(page, "data-witness-pixels=\"", "\""), "0");
  EXPECT_EQ(between(page, "<p id=\"legend\">", "</p>").find("may touch"), std::string::npos);
  EXPECT_NE(page.find("<label id=\"witness-of\" hidden"), std::string::npos);
}

TEST_F(PageInBrowser, ShowsItselfAsAPicture) {
  const std::string file = path("free.html"), picture = path("free.png");
  ASSERT_EQ(this->run("check " + armAndBall() + " --from 0,0 --to 40deg,0 --html " + file).status, 0);
  browse(file, "--screenshot=" + picture);
  EXPECT_GT(read(picture).size(), 20000u);
}

}  // namespace

}  // namespace page_test
