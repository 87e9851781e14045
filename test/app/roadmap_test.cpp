// SPDX-License-Identifier: BSD-3-Clause
// fcl_artic roadmap: made once, certified again for a scene, and read by others.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <vector>

#include <nlohmann/json.hpp>
#ifdef FCL_ARTIC_HAS_BOOST_GRAPH
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/graphml.hpp>
#endif

#include "certificate/sha256.h"
#include "hdf5/hdf5.h"
#include "roadmap/nearest.h"
#include "run_program.h"

namespace roadmap_test {

namespace {

using Json = nlohmann::json;
using fcl_artic::app::NearestPoints;
using fcl_artic::hdf5::File;

class RoadmapTest : public ProgramTest {
 protected:
  Outcome make(const std::string& out, const std::string& more = "--vertices 120 --neighbours 6") const {
    return run("roadmap make --robot " + arm() + " --out " + path(out) + " " + more);
  }
  Outcome certify(const std::string& map, const std::string& out, const std::string& more = "") const {
    return run("roadmap certify " + path(map) + " " + armAndBall() + " --out " + path(out) + " " + more);
  }
};

TEST(NearestPointsTest, AreThoseThatLookingAtAllFinds) {
  std::mt19937 random(5);
  int compared = 0;
  for (const std::size_t n : {1, 2, 13, 400}) {
    for (const std::size_t dimensions : {1, 3, 7}) {
      std::vector<double> points(n * dimensions);
      // On a grid, so that many are equally far.
      for (double& x : points) x = std::uniform_int_distribution<int>(0, 6)(random);
      const NearestPoints nearest(points, dimensions);
      for (std::size_t i = 0; i < n; i += 7) {
        std::vector<std::pair<double, std::int64_t>> all;
        for (std::size_t j = 0; j < n; ++j) {
          double squared = 0;
          for (std::size_t d = 0; d < dimensions; ++d)
            squared += std::pow(points[i * dimensions + d] - points[j * dimensions + d], 2);
          if (j != i) all.emplace_back(squared, static_cast<std::int64_t>(j));
        }
        std::sort(all.begin(), all.end());
        const std::vector<std::int64_t> found = nearest.of(i, 9);
        ASSERT_EQ(found.size(), std::min<std::size_t>(9, n - 1));
        for (std::size_t k = 0; k < found.size(); ++k, ++compared)
          ASSERT_EQ(found[k], all[k].second) << n << " " << dimensions;
      }
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST_F(RoadmapTest, EdgesOfASceneAreWhatCheckSaysOneByOne) {
  ASSERT_EQ(make("map.h5").status, 0);
  const Outcome done = certify("map.h5", "scene.h5");
  ASSERT_EQ(done.status, 1) << done.err;
  EXPECT_EQ(done.err, "");
  const File map(path("scene.h5"));
  const std::size_t edges = map.shape("edges")[0];
  std::vector<double> q, lower, upper;
  std::vector<std::int64_t> ends, status;
  map.read("configurations", 0, 120, q);
  map.read("edges", 0, edges, ends);
  map.read("status", 0, edges, status);
  map.read("t_lower", 0, edges, lower);
  map.read("t_upper", 0, edges, upper);
  std::string questions;
  for (std::size_t e = 0; e < edges; ++e) {
    const auto a = static_cast<std::size_t>(ends[2 * e]), b = static_cast<std::size_t>(ends[2 * e + 1]);
    questions += Json{{"from", {q[2 * a], q[2 * a + 1]}}, {"to", {q[2 * b], q[2 * b + 1]}}}.dump() + "\n";
  }
  const Outcome one_by_one = run("check " + armAndBall() + " --lines " + write("q.jsonl", questions));
  std::istringstream lines(one_by_one.out);
  std::map<std::string, int> seen;
  std::string line;
  for (std::size_t e = 0; e < edges; ++e) {
    ASSERT_TRUE(std::getline(lines, line));
    const Json answer = Json::parse(line);
    const std::string said = status[e] == 1 ? "free" : status[e] == 2 ? "contact" : "other";
    ++seen[said];
    EXPECT_EQ(said, answer.at("status")) << e;
    EXPECT_EQ(lower[e], answer.at("t_lower").get<double>());
    EXPECT_EQ(upper[e], answer.at("t_upper").get<double>());
  }
  std::printf("%zu edges: %d free, %d contact\n", edges, seen["free"], seen["contact"]);
  EXPECT_GT(seen["free"], 100);
  EXPECT_GT(seen["contact"], 20);

  // The file of a roadmap is one of edges.
  const Outcome as_edges = run("certify --edges " + path("map.h5") + " " + armAndBall() + " --out " + path("edges"));
  ASSERT_EQ(as_edges.status, 0) << as_edges.err;
  const Json summary = Json::parse(read(path("edges/summary.json")));
  EXPECT_EQ(summary.at("free"), seen["free"]);
  EXPECT_EQ(summary.at("contact"), seen["contact"]);
}

/// Two arms on one base that can meet: not all edges between free configurations are free.
TEST_F(RoadmapTest, LinksAreCheckedWhenItIsMadeAndAgainWhereThatDoesNotHold) {
  const auto link = [](const char* name, const char* y) {
    return std::string("<link name='") + name + "'><collision><origin xyz='0 " + y +
           " 0'/><geometry><box size='0.1 1 0.1'/></geometry></collision></link>";
  };
  const auto joint = [](const char* name, const char* y) {
    return std::string("<joint name='") + name + "_joint' type='revolute'><parent link='base'/><child link='" + name +
           "'/><origin xyz='0 " + y +
           " 0'/><axis xyz='0 0 1'/><limit lower='-1.5' upper='1.5' effort='1' velocity='1'/></joint>";
  };
  const std::string robot =
      write("two.urdf", "<robot name='two'><link name='base'/>" + link("left", "0.5") + link("right", "-0.5") +
                            joint("left", "-0.6") + joint("right", "0.6") + "</robot>");
  const std::string options = "--vertices 150 --neighbours 8 ";
  ASSERT_EQ(run("roadmap make --robot " + robot + " --no-self --out " + path("loose.h5") + " " + options).status, 0);
  ASSERT_EQ(run("roadmap make --robot " + robot + " --out " + path("map.h5") + " " + options).status, 0);
  const auto counts = [&](const std::string& map, const std::string& more, std::string& err) {
    const Outcome done =
        run("roadmap certify " + path(map) + " --robot " + robot + " --out " + path("out.csv") + " " + more);
    err = done.err;
    const std::string csv = read(path("out.csv"));
    std::pair<int, int> free_and_contact;
    std::istringstream lines(csv);
    for (std::string line; std::getline(lines, line);) {
      free_and_contact.first += line.find(",free,") != std::string::npos;
      free_and_contact.second += line.find(",contact,") != std::string::npos;
    }
    EXPECT_EQ(done.status, free_and_contact.second > 0 ? 1 : 0) << done.err;
    return free_and_contact;
  };
  std::string err;
  const auto loose = counts("loose.h5", "", err);
  EXPECT_NE(err.find("checked against links again: the roadmap was made without that"), std::string::npos) << err;
  EXPECT_GT(loose.second, 50);
  EXPECT_EQ(counts("map.h5", "", err).second, 0);
  EXPECT_EQ(err, "");
  // Edges are gone along both ways: contact at one end can't be left out.
  for (const std::string& verb : {std::string("make"), "certify " + path("map.h5")}) {
    const Outcome ignoring =
        run("roadmap " + verb + " --robot " + robot + " --ignore-initial-contact --out " + path("x.h5"));
    EXPECT_EQ(ignoring.status, 2);
    EXPECT_NE(ignoring.err.find("--ignore-initial-contact"), std::string::npos) << ignoring.err;
  }
  // Edges that somebody has added are not those that were proven.
  {
    const File made(path("map.h5"));
    std::vector<double> configurations;
    std::vector<std::int64_t> edges;
    const std::size_t vertices = made.shape("configurations")[0];
    made.read("configurations", 0, vertices, configurations);
    made.read("edges", 0, made.shape("edges")[0], edges);
    for (std::int64_t v = 1; v < static_cast<std::int64_t>(vertices); ++v) edges.insert(edges.end(), {0, v});
    fcl_artic::hdf5::Image image;
    image.add("configurations", {vertices, 2}, configurations.data());
    image.attribute("configurations", "joints", made.strings("configurations", "joints"));
    image.add("edges", {edges.size() / 2, 2}, edges.data());
    for (const char* name : {"format", "robot", "self_margin", "sha256"}) {
      ASSERT_EQ(made.strings("", name).size(), 1u) << name;
      image.attribute("", name, made.strings("", name)[0]);
    }
    write("more.h5", image.bytes());
  }
  EXPECT_GT(counts("more.h5", "", err).second, 0);
  EXPECT_NE(err.find("the roadmap was changed since it was made"), std::string::npos) << err;
  // A roadmap that is certified again holds for the same edges.
  ASSERT_EQ(run("roadmap certify " + path("map.h5") + " --robot " + robot + " --out " + path("again.h5")).status, 0);
  EXPECT_EQ(counts("again.h5", "", err).second, 0);
  EXPECT_EQ(err, "");
  // A larger margin than was proven, and another robot.
  EXPECT_GT(counts("map.h5", "--margin 0.05", err).second, 0);
  EXPECT_NE(err.find("margin of 0 m"), std::string::npos) << err;
  std::string longer = read(robot);
  longer.replace(longer.find("0.1 1 0.1"), 9, "0.1 1.3 0.1");
  write("two.urdf", longer);
  EXPECT_GT(counts("map.h5", "", err).second, 0);
  EXPECT_NE(err.find("another robot"), std::string::npos) << err;
  // The same through a pipe, of which no file can be read again.
  const auto piped = [&](const std::string& urdf, const std::string& arguments) {
    const std::string command = "cat \"" + urdf + "\" | \"" + std::string(FCL_ARTIC_PROGRAM) + "\" roadmap " +
                                arguments + " --robot /dev/stdin >\"" + path("out") + "\" 2>\"" + path("err") + "\"";
    EXPECT_LT(WEXITSTATUS(std::system(command.c_str())), 2) << read(path("err"));
    return read(path("err"));
  };
  write("short.urdf", longer.replace(longer.find("0.1 1.3 0.1"), 11, "0.1 1 0.1"));
  piped(path("short.urdf"), "make --out " + path("piped.h5") + " " + options);
  EXPECT_EQ(
      piped(path("short.urdf"), "certify " + path("piped.h5") + " --out " + path("same.csv")).find("another robot"),
      std::string::npos);
  EXPECT_NE(
      piped(path("two.urdf"), "certify " + path("piped.h5") + " --out " + path("other.csv")).find("another robot"),
      std::string::npos);
  // Another load: points that are larger.
  write("points.xyz", "0 0 0\n");
  const std::string load = " --robot " + robot + " --attach left=" + path("points.xyz") + "@1,0,0 --point-radius ";
  ASSERT_EQ(run("roadmap make" + load + "0.01 --out " + path("load.h5") + " " + options).status, 0);
  EXPECT_EQ(run("roadmap certify " + path("load.h5") + load + "0.01 --out " + path("same.csv")).err, "");
  EXPECT_NE(
      run("roadmap certify " + path("load.h5") + load + "0.2 --out " + path("larger.csv")).err.find("another load"),
      std::string::npos);
}

TEST_F(RoadmapTest, GraphMlIsReadByBoostGraph) {
#ifdef FCL_ARTIC_HAS_BOOST_GRAPH
  ASSERT_EQ(make("map.h5").status, 0);
  ASSERT_EQ(certify("map.h5", "map.graphml").status, 1);
  struct Vertex {
    double hinge = 9, rail = 9;
  };
  struct Edge {
    std::string status, bodies;
    double weight = 0, t_lower = 0, t_upper = 0;
    int certain = 0;
  };
  using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS, Vertex, Edge>;
  Graph graph;
  boost::dynamic_properties names;
  names.property("hinge", boost::get(&Vertex::hinge, graph));
  names.property("rail", boost::get(&Vertex::rail, graph));
  names.property("status", boost::get(&Edge::status, graph));
  names.property("bodies", boost::get(&Edge::bodies, graph));
  names.property("weight", boost::get(&Edge::weight, graph));
  names.property("t_lower", boost::get(&Edge::t_lower, graph));
  names.property("t_upper", boost::get(&Edge::t_upper, graph));
  names.property("certain", boost::get(&Edge::certain, graph));
  std::ifstream in(path("map.graphml"));
  boost::read_graphml(in, graph, names);
  ASSERT_EQ(boost::num_vertices(graph), 120u);
  int contacts = 0;
  for (const auto& e : boost::make_iterator_range(boost::edges(graph))) {
    const Vertex &a = graph[boost::source(e, graph)], &b = graph[boost::target(e, graph)];
    EXPECT_DOUBLE_EQ(graph[e].weight, std::hypot(a.hinge - b.hinge, a.rail - b.rail));
    const bool contact = graph[e].status == "contact";
    contacts += contact;
    EXPECT_EQ(graph[e].bodies, contact ? "arm, ball" : "");
    EXPECT_EQ(contact, graph[e].t_lower < 1);
  }
  EXPECT_GT(contacts, 20);
#else
  GTEST_SKIP() << "built without boost::graph";
#endif
}

TEST_F(RoadmapTest, GraphMlIsReadByNetworkx) {
  if (std::system("python3 -c 'import networkx' 2>/dev/null") != 0) GTEST_SKIP() << "no networkx";
  ASSERT_EQ(make("map.h5").status, 0);
  ASSERT_EQ(certify("map.h5", "map.graphml").status, 1);
  ASSERT_EQ(certify("map.h5", "valid.graphml", "--valid-only").status, 1);
  ASSERT_EQ(certify("map.h5", "map.csv").status, 1);
  const std::string script = write("read.py", R"(
import csv, sys
import networkx
whole, valid = networkx.read_graphml(sys.argv[1]), networkx.read_graphml(sys.argv[2])
rows = list(csv.DictReader(open(sys.argv[3])))
assert whole.number_of_nodes() == valid.number_of_nodes() == 120
assert whole.number_of_edges() == len(rows)
for row in rows:
    edge = whole["n" + row["source"]]["n" + row["target"]]
    assert edge["status"] == row["status"] and float(edge["t_lower"]) == float(row["t_lower"])
    assert float(edge["weight"]) == float(row["weight"]) and edge.get("bodies", "") == row["bodies"]
    assert valid.has_edge("n" + row["source"], "n" + row["target"]) == (row["status"] == "free")
print(valid.number_of_edges(), len(rows))
)");
  const int status = std::system(("python3 " + script + " " + path("map.graphml") + " " + path("valid.graphml") + " " +
                                  path("map.csv") + " >" + path("said") + " 2>&1")
                                     .c_str());
  EXPECT_EQ(status, 0) << read(path("said"));
}

TEST_F(RoadmapTest, FilesOfEarlierRunsAreNotLeft) {
  const std::string broken = write("broken.urdf", "<robot name='x'><link name=''/>");
  for (const char* verb : {"make ", "certify "}) {
    const std::string out = write("old.csv", "old"), vertices = write("old.vertices.csv", "old");
    const std::string given = std::string(verb) == "make " ? "" : write("map.h5", "none") + " ";
    EXPECT_EQ(run(std::string("roadmap ") + verb + given + "--robot " + broken + " --out " + out).status, 2);
    EXPECT_EQ(read(out), "");
    EXPECT_EQ(read(vertices), "");
  }
  const std::string map = write("map.h5", "none");
  const Outcome same = run("roadmap certify " + map + " --robot " + arm() + " --out " + map);
  EXPECT_EQ(same.status, 2);
  EXPECT_EQ(read(map), "none");
}

TEST_F(RoadmapTest, ExitStatusIsThatOfTheWorstEdge) {
  ASSERT_EQ(make("map.h5", "--vertices 30 --neighbours 3").status, 0);
  EXPECT_EQ(certify("map.h5", "x.csv").status, 1);
  EXPECT_EQ(certify("map.h5", "x.csv", "--budget 1").status, 3);
  const auto alone = [&](const std::string& map, const std::string& more) {
    return run("roadmap certify " + path(map) + " --robot " + arm() + " --out " + path("x.csv") + more);
  };
  EXPECT_EQ(alone("map.h5", "").status, 0);
  const Outcome nothing = alone("map.h5", " --no-self");
  EXPECT_EQ(nothing.status, 3);
  EXPECT_NE(nothing.out.find("NOTHING CHECKED"), std::string::npos) << nothing.out;
  ASSERT_EQ(make("empty.h5", "--vertices 1 --neighbours 3").status, 0);
  EXPECT_EQ(certify("empty.h5", "x.csv").status, 3);
  EXPECT_EQ(certify("arm.urdf", "x.csv").status, 2);
  // An output that can't be written is an error, and the answer is printed all the same.
  std::filesystem::create_symlink("/dev/full", path("full.csv"));
  const Outcome full = certify("map.h5", "full.csv");
  EXPECT_EQ(full.status, 2);
  EXPECT_NE(full.out.find(" free, "), std::string::npos) << full.out;
  for (const char* verb : {"roadmap", "roadmap make", "roadmap certify", "certify --merge"}) {
    const Outcome help = run(std::string(verb) + " --help");
    EXPECT_NE(help.out.find("Exit status: "), std::string::npos) << verb;
  }
}

/// An edge is of use only beside the vertices that it was proven for.
TEST_F(RoadmapTest, EdgesNameTheirVertices) {
  const auto hashOf = [&](const std::string& out, const std::string& more) {
    EXPECT_EQ(make(out + ".csv", more).status, 0);
    const std::string edges = read(path(out + ".csv"));
    const std::string hash = fcl_artic::certificate::sha256Text(read(path(out + ".vertices.csv")));
    std::istringstream lines(edges);
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "source,target,weight,vertices_sha256");
    int rows = 0;
    for (; std::getline(lines, line); ++rows) EXPECT_EQ(line.substr(line.rfind(',') + 1), hash);
    EXPECT_GT(rows, 10);
    return hash;
  };
  EXPECT_NE(hashOf("one", "--vertices 30 --neighbours 3 --seed 1"),
            hashOf("two", "--vertices 30 --neighbours 3 --seed 2"));
  // By way of a link: the vertices stand beside the link, and an earlier run's go.
  std::filesystem::create_directories(path("real"));
  write("real/map.vertices.csv", "somebody's");
  std::filesystem::create_symlink("real/map.csv", path("map.csv"));
  hashOf("map", "--vertices 30 --neighbours 3");
  EXPECT_EQ(read(path("real/map.vertices.csv")), "somebody's");
}

TEST_F(RoadmapTest, GivenConfigurationsAreItsFirstVertices) {
  const std::string given = write("given.csv", "rail,hinge\n0.25,0.5\n-0.5,1.75\n");
  ASSERT_EQ(make("map.h5", "--vertices 30 --with " + given).status, 0);
  std::vector<double> q;
  File(path("map.h5")).read("configurations", 0, 2, q);
  EXPECT_EQ(q, (std::vector<double>{0.5, 0.25, 1.75, -0.5}));
  // In a scene that always stands there they are to be free.
  const Outcome touching = run("roadmap make " + armAndBall() + " --out " + path("x.h5") + " --vertices 30 --with " +
                               write("bad.csv", "hinge,rail\n1.0471975511965976,0\n"));
  EXPECT_EQ(touching.status, 2);
  EXPECT_NE(touching.err.find("given configuration 0 is not proven free: arm and ball"), std::string::npos)
      << touching.err;
  EXPECT_NE(make("x.h5", "--with " + write("far.csv", "hinge,rail\n3,0\n")).err.find("given configuration 0: "),
            std::string::npos);
  // Limits as of plans: a sensor's error is noted.
  const Outcome near = make("near.h5", "--vertices 3 --with " + write("near.csv", "rail,hinge\n0,2.0009\n"));
  EXPECT_EQ(near.status, 0);
  EXPECT_NE(near.err.find("given configuration: joint 'hinge': some values are beyond its limits [-1, 2], by at most "
                          "0.0009 rad"),
            std::string::npos)
      << near.err;
  // Notes of the file are told.
  const Outcome degrees =
      make("degrees.h5", "--vertices 3 --with " + write("degrees.csv", "# angles in degrees\nhinge,rail\n0.5,0\n"));
  EXPECT_EQ(degrees.status, 0);
  EXPECT_NE(degrees.err.find("degrees.csv': "), std::string::npos) << degrees.err;
  EXPECT_NE(make("x.dot").err.find("written as .h5, .graphml or .csv"), std::string::npos);
  EXPECT_NE(certify("arm.urdf", "x.h5").err.find("can't be read as an HDF5 file"), std::string::npos);
}

}  // namespace

}  // namespace roadmap_test
