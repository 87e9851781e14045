// SPDX-License-Identifier: BSD-3-Clause
//
// Every geometry against every other one, along every motion, through the drop-in: 19 x 19 ordered pairs, 7 motions,
// one or both objects moving, a sweep that hits and one that stays clear. Each cell runs in a child process of its own,
// with a time limit.
//
//   FCL_ARTIC_MATRIX_BATCH=<n>    so many cells a child. The one that a child dies at is known, and the next child goes
//   on after it. FCL_ARTIC_MATRIX_ROWS=<file>  appends a line for every cell.
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <new>

#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/screw_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>
#include <gtest/gtest.h>

#include "fcl_artic/continuous_collision.h"
#include "geometries.h"

namespace matrix_test {

namespace {

using fcl::Matrix3d;
using fcl::Transform3d;
using fcl::Vector3d;

constexpr unsigned kSecondsPerCell = 20;
constexpr double kTocErr = 1e-6;
/// First touch of a hit, at 1 of 3 m.
constexpr double kTouch = 1.0 / 3;
/// The poses' own rounding moves the touch by this much: some ulp of 10 m at 3 m per unit of time.
constexpr double kRounding = 1e-13;
/// Both at the tolerance of time before the touch and 1e-6 m before it may contact be reported.
constexpr double kEarly = kTocErr + 1e-6 / 3 + kRounding;

enum class Way { trans, linear, screw, translation_motion, interp_motion, screw_motion, spline_motion };
const char* const kWays[] = {"CCDM_TRANS",   "CCDM_LINEAR", "CCDM_SCREW",  "TranslationMotion",
                             "InterpMotion", "ScrewMotion", "SplineMotion"};
constexpr bool isObject(Way way) {
  return way >= Way::translation_motion;
}

struct Cell {
  std::size_t geometry1, geometry2;
  Way way;
  bool both_move, hit;
};

Transform3d pose(const Matrix3d& R, const Vector3d& x) {
  Transform3d M = Transform3d::Identity();
  M.linear() = R;
  M.translation() = x;
  return M;
}

/// One object's way: straight, and turning about x, in a world that is turned by W.
struct Sweep {
  Matrix3d start;
  Vector3d from, way;  ///< of the geometry's origin, world
  Vector3d axis;       ///< that it turns about, world
  double angle;

  Matrix3d rotation(double t) const { return Eigen::AngleAxisd(angle * t, axis) * start; }
  Transform3d begin() const { return pose(start, from); }
  Transform3d end() const { return pose(rotation(1), from + way); }
};

std::shared_ptr<fcl::MotionBased> motionObject(const Sweep& s, Way way) {
  switch (way) {
    case Way::translation_motion:
      return std::make_shared<fcl::TranslationMotiond>(s.begin(), s.end());
    case Way::interp_motion:
      // The one constructor that leaves nothing uninitialised.
      return std::make_shared<fcl::InterpMotion<double>>(s.start, s.from, s.rotation(1), s.from + s.way,
                                                         Vector3d(0, 0, 0));
    case Way::screw_motion: {
      // Without a turn FCL's object goes |d| times as far as it is told (fcl#119).
      const double d = s.way.norm();
      const Vector3d to = s.angle == 0 && d > 0 ? Vector3d(s.from + s.way / std::sqrt(d)) : Vector3d(s.from + s.way);
      return std::make_shared<fcl::ScrewMotion<double>>(s.start, s.from, s.rotation(1), to);
    }
    default: {
      // A uniform B-spline whose control points are evenly spaced is the line from the second to the third.
      const Eigen::AngleAxisd start(s.start);
      const Vector3d d = s.way, r = start.angle() * start.axis(), dr = s.angle * s.axis;
      return std::make_shared<fcl::SplineMotion<double>>(s.from - d, s.from, s.from + d, s.from + 2 * d, r - dr, r,
                                                         r + dr, r + 2 * dr);
    }
  }
}

struct Answer {
  bool done = false, is_collide = false, thrown = false, poses_right = false, motions_left_alone = true;
  double returned = -1, time = -1;
};

class Matrix {
 public:
  Matrix() : geometries_(dropin::allGeometries()) {}

  std::vector<Cell> cells(Way way) const {
    std::vector<Cell> all;
    for (std::size_t i = 0; i < geometries_.size(); ++i) {
      for (std::size_t j = 0; j < geometries_.size(); ++j) {
        for (const bool both : {false, true}) {
          for (const bool hit : {false, true}) all.push_back({i, j, way, both, hit});
        }
      }
    }
    return all;
  }

  std::string name(const Cell& c) const {
    return std::string(geometries_[c.geometry1].name) + " - " + geometries_[c.geometry2].name + ", " +
           kWays[static_cast<int>(c.way)] + (c.both_move ? ", both move" : ", second moves") +
           (c.hit ? ", hit" : ", clear");
  }

  /// The two sweeps. Object 1 looks along x and object 2 against it; a plane across x keeps them apart until their
  /// tips, which are on the x axis whatever the turn about it, meet at t = 1/3. Clear: the gap goes from 1 m to 0.5 m
  /// while they pass one another.
  void sweeps(const Cell& c, Sweep& s1, Sweep& s2) const {
    const auto &a = geometries_[c.geometry1], &b = geometries_[c.geometry2];
    const bool spline = c.way == Way::spline_motion;
    // The world is turned; a spline's only about x, as its rotation vector then stays on a line: exp(w) is a turn about
    // x.
    Matrix3d W =
        Eigen::AngleAxisd(0.7, spline ? Vector3d(1, 0, 0) : Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    // Whether a motion turns about x. For half-spaces and planes x is the normal, so two of them stay parallel.
    const auto turns = [&](const auto& g) {
      if (c.way == Way::trans || c.way == Way::translation_motion) return false;
      return !spline || g.turn.isIdentity();
    };
    // Object 2 is turned round; not where it must start from a turn about x, but there it reaches as far to the left.
    Matrix3d round = Vector3d(-1, -1, 1).asDiagonal();
    if (spline && turns(b)) round.setIdentity();
    const Vector3d x = W.col(0);
    Vector3d relative = c.hit ? Vector3d(-3, 0, 0) : Vector3d(-0.5, 3, 0);
    const Vector3d away(a.reach + b.reach + 1, c.hit ? 0 : -1.5, 0);
    Vector3d way1 = Vector3d::Zero(), way2 = relative;
    if (c.both_move) {
      way1 = -0.25 * relative;
      way2 = 0.75 * relative;
      // Both drift along, but for screws, whose ways then would bend.
      const bool screw = c.way == Way::screw || c.way == Way::screw_motion;
      if (!screw) {
        way1 += Vector3d(0.2, -0.3, 0.4);
        way2 += Vector3d(0.2, -0.3, 0.4);
      }
    }
    const Vector3d origin(0.3, -0.2, 0.1);
    s1 = {W * a.turn, W * origin, W * way1, x, turns(a) && c.both_move ? 0.8 : 0};
    s2 = {W * round * b.turn, W * (origin + away), W * way2, x, turns(b) ? -1.2 : 0};
  }

  Answer run(const Cell& c) const {
    Sweep s1, s2;
    sweeps(c, s1, s2);
    const auto &a = geometries_[c.geometry1], &b = geometries_[c.geometry2];
    fcl::ContinuousCollisionRequestd request;
    request.toc_err = kTocErr;
    fcl::ContinuousCollisionResultd result;
    result.is_collide = !c.hit;  // of an earlier query
    result.time_of_contact = 0.77;
    Answer answer;
    try {
      if (isObject(c.way)) {
        const auto m1 = motionObject(s1, c.way), m2 = motionObject(s2, c.way);
        m1->integrate(0.9);  // of an earlier query, too
        m2->integrate(0.7);
        Transform3d before, after;
        m2->getCurrentTransform(before);
        if (c.both_move) {
          const fcl::ContinuousCollisionObjectd o1(a.geometry, m1), o2(b.geometry, m2);
          answer.returned = fcl_artic::collide(&o1, &o2, request, result);
        } else {
          answer.returned =
              fcl_artic::continuousCollide(a.geometry.get(), m1.get(), b.geometry.get(), m2.get(), request, result);
        }
        m2->getCurrentTransform(after);
        answer.motions_left_alone = before.matrix() == after.matrix();
      } else {
        request.ccd_motion_type = c.way == Way::trans    ? fcl::CCDM_TRANS
                                  : c.way == Way::linear ? fcl::CCDM_LINEAR
                                                         : fcl::CCDM_SCREW;
        if (c.both_move) {
          const fcl::CollisionObjectd o1(a.geometry, s1.begin()), o2(b.geometry, s2.begin());
          answer.returned = fcl_artic::continuousCollide(&o1, s1.end(), &o2, s2.end(), request, result);
        } else {
          answer.returned = fcl_artic::continuousCollide(a.geometry.get(), s1.begin(), s1.end(), b.geometry.get(),
                                                         s2.begin(), s2.end(), request, result);
        }
      }
    } catch (const std::exception& e) {
      answer.thrown = true;
      std::fprintf(stderr, "%s: %s\n", name(c).c_str(), e.what());
    }
    answer.is_collide = result.is_collide;
    answer.time = result.time_of_contact;
    // Along x, at least, where every motion is a line.
    const double t = result.time_of_contact;
    answer.poses_right = std::abs(s1.axis.dot(result.contact_tf1.translation() - s1.from - t * s1.way)) < 1e-12 &&
                         std::abs(s2.axis.dot(result.contact_tf2.translation() - s2.from - t * s2.way)) < 1e-12 &&
                         (result.contact_tf2.linear() * s2.start.transpose() * s2.axis - s2.axis).norm() < 1e-12;
    return answer;
  }

 private:
  std::vector<dropin::Geometry<double>> geometries_;
};

enum class Verdict { right, late, early, missed, false_alarm, thrown, spoilt, crashed, timed_out };
const char* const kVerdicts[] = {"right",  "late",   "early",   "missed",   "false",
                                 "thrown", "spoilt", "crashed", "timed out"};
constexpr int kNumVerdicts = 9;

Verdict judge(const Cell& c, const Answer& a) {
  if (a.thrown) return Verdict::thrown;
  if (c.hit && !a.is_collide) return Verdict::missed;
  if (!c.hit && a.is_collide) return Verdict::false_alarm;
  if (!a.motions_left_alone || !a.poses_right || a.returned != a.time) return Verdict::spoilt;
  if (!c.hit) return a.time == 1 ? Verdict::right : Verdict::spoilt;
  if (a.time > kTouch + kRounding) return Verdict::late;
  return a.time < kTouch - kEarly ? Verdict::early : Verdict::right;
}

/// Memory that children write to and their parent reads.
class SharedAnswers {
 public:
  explicit SharedAnswers(std::size_t count) : bytes_(count * sizeof(Answer)) {
    memory_ = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory_ == MAP_FAILED) throw std::bad_alloc();
    answers_ = new (memory_) Answer[count];
  }
  ~SharedAnswers() { munmap(memory_, bytes_); }
  SharedAnswers(const SharedAnswers&) = delete;
  SharedAnswers& operator=(const SharedAnswers&) = delete;
  Answer& operator[](std::size_t i) { return answers_[i]; }

 private:
  std::size_t bytes_;
  void* memory_;
  Answer* answers_;
};

/// Runs the cells in children, `batch` a child, and says what became of each.
template <class Run>
std::vector<Verdict> runInChildren(const std::vector<Cell>& cells, SharedAnswers& answers, std::size_t batch,
                                   unsigned seconds_per_cell, Run&& run) {
  std::vector<Verdict> verdicts;
  while (verdicts.size() < cells.size()) {
    const std::size_t begin = verdicts.size(), end = std::min(begin + batch, cells.size());
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("fork failed");
    if (child == 0) {
      for (std::size_t i = begin; i < end; ++i) {
        alarm(seconds_per_cell);
        answers[i] = run(cells[i]);
        answers[i].done = true;
      }
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    for (std::size_t i = begin; i < end && answers[i].done; ++i) verdicts.push_back(judge(cells[i], answers[i]));
    const bool timed_out = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
    if (verdicts.size() < end) verdicts.push_back(timed_out ? Verdict::timed_out : Verdict::crashed);
  }
  return verdicts;
}

class DropInMatrix : public testing::TestWithParam<Way> {};

TEST_P(DropInMatrix, EveryCellIsRight) {
  const Matrix matrix;
  const std::vector<Cell> cells = matrix.cells(GetParam());
  ASSERT_EQ(cells.size(), 19u * 19u * 4u);
  const char* text = std::getenv("FCL_ARTIC_MATRIX_BATCH");
  const std::size_t batch = text ? std::max(1, std::atoi(text)) : 1;
  SharedAnswers answers(cells.size());
  const std::vector<Verdict> verdicts =
      runInChildren(cells, answers, batch, kSecondsPerCell, [&](const Cell& cell) { return matrix.run(cell); });

  int count[2][2][kNumVerdicts] = {};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    ++count[cells[i].both_move][cells[i].hit][static_cast<int>(verdicts[i])];
    EXPECT_EQ(verdicts[i], Verdict::right)
        << matrix.name(cells[i]) << ": " << kVerdicts[static_cast<int>(verdicts[i])] << ", t = " << answers[i].time;
  }
  std::printf("%-18s %-12s %-6s %6s", kWays[static_cast<int>(GetParam())], "moving", "sweep", "cells");
  for (const char* verdict : kVerdicts) std::printf(" %9s", verdict);
  std::printf("\n");
  for (const int both : {0, 1}) {
    for (const int hit : {1, 0}) {
      std::printf("%-18s %-12s %-6s %6d", "", both ? "both" : "second", hit ? "hit" : "clear", 19 * 19);
      for (const int n : count[both][hit]) std::printf(" %9d", n);
      std::printf("\n");
    }
  }
  if (const char* path = std::getenv("FCL_ARTIC_MATRIX_ROWS")) {
    std::ofstream rows(path, std::ios::app);
    rows.precision(17);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      rows << matrix.name(cells[i]) << ", " << answers[i].time << ", " << kVerdicts[static_cast<int>(verdicts[i])]
           << '\n';
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, DropInMatrix,
                         testing::Values(Way::trans, Way::linear, Way::screw, Way::translation_motion,
                                         Way::interp_motion, Way::screw_motion, Way::spline_motion),
                         [](const auto& info) {
                           std::string name = kWays[static_cast<int>(info.param)];
                           name.erase(std::remove(name.begin(), name.end(), '_'), name.end());
                           return name;
                         });

/// The answer that is right for a hit.
Answer hitAnswer() {
  Answer a;
  a.poses_right = a.is_collide = true;
  a.time = a.returned = kTouch - 1e-7;
  return a;
}

TEST(DropInMatrixJudge, SeesWhatIsWrong) {
  const Cell hit{0, 0, Way::trans, false, true}, clear{0, 0, Way::trans, false, false};
  Answer a = hitAnswer();
  EXPECT_EQ(judge(hit, a), Verdict::right);
  EXPECT_EQ(judge(clear, a), Verdict::false_alarm);
  a.time = a.returned = kTouch + 1e-9;
  EXPECT_EQ(judge(hit, a), Verdict::late);
  a.time = a.returned = kTouch - 1e-5;
  EXPECT_EQ(judge(hit, a), Verdict::early);
  a.is_collide = false;
  a.time = a.returned = 1;
  EXPECT_EQ(judge(hit, a), Verdict::missed);
  EXPECT_EQ(judge(clear, a), Verdict::right);
  a.returned = -1;
  EXPECT_EQ(judge(clear, a), Verdict::spoilt);
}

// A child that dies or hangs is charged to the cell that it was at, and the others run.
TEST(DropInMatrixJudge, KnowsTheCellThatAChildEndedAt) {
  const std::vector<Cell> cells(6, Cell{0, 0, Way::trans, false, true});
  for (const std::size_t batch : {std::size_t{1}, std::size_t{4}}) {
    SharedAnswers answers(cells.size());
    const std::vector<Verdict> verdicts = runInChildren(cells, answers, batch, 1, [&](const Cell& cell) {
      const auto i = &cell - cells.data();
      if (i == 1) raise(SIGSEGV);
      if (i == 4) {
        for (volatile bool forever = true; forever;) {
        }
      }
      return hitAnswer();
    });
    const std::vector<Verdict> expected{Verdict::right, Verdict::crashed,   Verdict::right,
                                        Verdict::right, Verdict::timed_out, Verdict::right};
    EXPECT_EQ(verdicts, expected) << batch << " cells a child";
  }
}

}  // namespace

}  // namespace matrix_test
