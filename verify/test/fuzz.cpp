// SPDX-License-Identifier: BSD-3-Clause
// The first byte says what the rest is. With 0 it is records for a fixed world. With 1 it is a world, a motion and a
// proof with their hashes made to fit, separated by bytes 30. It is URDF (2), SRDF (3), STL (4), OBJ (5), a scene's
// URDF (6) or a plan (7). Wrong input may throw BadInput or be refused. A claim that is verified and yet wrong at a
// sample is a fault, as is a crash.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "../meshes.h"
#include "../readers.h"
#include "../report.h"
#include "worlds.h"

using namespace verify;
using namespace verify::test;

namespace {

const std::string kWorld = kHead + "variable a\nframe link1 0 " + hex(M{}) + "\nturn " + hex(V{0, 0, 1}) + " 0 " +
                           hex(1) + " " + hex(0) + "\ngeometry box " + hex(V{1, 0.2, 0.2}) + "\n" +
                           boxMesh({0.5, 0.5, 0.5}, true) + "body obstacle o 0 1 " + hex([] {
                             M m;
                             m.t = {2, 0, 0};
                             return m;
                           }()) +
                           "\nbody link link1 1 0 " + hex(M{}) + "\n";

std::string temporaryFile(const char* name, const std::string& content) {
  static const std::string folder = [] {
    std::string path = (std::filesystem::temp_directory_path() / "fcl_artic_verify_fuzz_XXXXXX").string();
    if (mkdtemp(path.data()) == nullptr) std::abort();
    return path;
  }();
  const std::string path = folder + "/" + name;
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

/// Far numbers are not judged: the samples' doubles would not be exact enough.
bool small(const World& world, const std::vector<M>& poses) {
  for (const M& m : poses)
    for (const double x : {m.t[0], m.t[1], m.t[2], m.R[0], m.R[4], m.R[8]})
      if (!(std::fabs(x) < 100)) return false;
  for (const Geometry& g : world.geometries)
    for (const std::vector<double>* list : {&g.numbers, &g.vertices, &g.cells})
      for (const double x : *list)
        if (!(std::fabs(x) < 100) || (g.unbounded() && std::fabs(x) < 1e-3 && x != 0)) return false;
  return true;
}
bool rotations(const World& world, const Motion& motion) {
  const auto proper = [](const double* R) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double d = R[3 * i] * R[3 * j] + R[3 * i + 1] * R[3 * j + 1] + R[3 * i + 2] * R[3 * j + 2];
        if (!(std::fabs(d - (i == j)) < 1e-12)) return false;
      }
    return true;
  };
  for (std::size_t f = 1; f < world.frames.size(); ++f)
    if (!proper(world.frames[f].numbers)) return false;
  for (const Body& b : world.bodies)
    if (!proper(b.numbers)) return false;
  for (const Piece& p : motion.pieces)
    for (const auto& o : p.orientations)
      if (!proper(o.second.data())) return false;
  return true;
}

void judgeBySamples(const World& world, const Motion& motion) {
  if (!rotations(world, motion) || world.bodies.size() > 12 || motion.pieces.size() > 4) return;
  std::size_t pieces = 0;
  for (const Body& b : world.bodies) pieces += world.geometries[static_cast<std::size_t>(b.geometry)].pieces();
  if (pieces > 60) return;
  const Sampler sampler(world, motion);
  for (std::size_t piece = 0; piece < motion.pieces.size(); ++piece) {
    const double end = piece + 1 == motion.pieces.size() ? motion.until : 1;
    for (int k = 0; k <= 6; ++k) {
      const double t = end * k / 6;
      const std::vector<M> poses = sampler.bodies(piece, t);
      if (!small(world, poses)) return;
      for (std::size_t a = 0; a < world.bodies.size(); ++a)
        for (const Opponent& o : opponents(world, motion, piece, static_cast<int>(a)))
          if (t > toDouble(o.from) + 1e-12 &&
              upperDistance(world, poses, static_cast<int>(a), o.body, 40) < toDouble(o.margin) - 1e-9) {
            std::fprintf(stderr, "fuzz: verified, and not so at t = %g of piece %zu\n", t, piece);
            std::abort();
          }
    }
  }
}

void verifyAndJudge(const World& world, const Record& record) {
  Options options;
  options.work = 200000;
  const Verdict verdict = verifyRecord(world, record, options);
  try {
    proofAsJson(world, record);
  } catch (const BadInput&) {
    if (verdict.verified) std::abort();  // what is verified can be printed
  }
  if (!verdict.verified) {
    if (verdict.reason.empty()) std::abort();
    return;
  }
  judgeBySamples(world, readMotion(record.motion, world));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const World fixed = readWorld(kWorld);
  const std::string rest(reinterpret_cast<const char*>(data + 1), size - 1);
  static const Motion moved = [] {
    MotionText text;
    text.pieces = {"q 0 " + hex(0) + " " + hex(1) + "\n"};
    return readMotion(text.write(fixed), fixed);
  }();
  const Packages packages;
  try {
    switch (data[0] % 8) {
      case 0:
        for (const Record& record : splitRecords(rest)) verifyAndJudge(fixed, record);
        break;
      case 1: {
        const std::size_t first = rest.find('\x1e'),
                          second = rest.find('\x1e', first == std::string::npos ? first : first + 1);
        if (second == std::string::npos) return 0;
        const std::string text = rest.substr(0, first);
        const World world = readWorld(text.empty() ? kWorld : text);
        const std::string motion =
            "fcl_artic motion 1\nworld " + hexOf(world.hash) + "\n" + rest.substr(first + 1, second - first - 1);
        const std::string proof = sha256(motion) + rest.substr(second + 1);
        verifyAndJudge(world, {motion, proof});
        break;
      }
      case 2:
        compareWithUrdf(fixed, temporaryFile("robot.urdf", rest), packages);
        break;
      case 3:
        compareWithSrdf(fixed, temporaryFile("robot.srdf", rest));
        break;
      case 6:
        compareWithScenes(fixed, {temporaryFile("scene.urdf", rest)}, packages);
        break;
      case 7:
        compareWithPlan(fixed, moved, readPlan(temporaryFile("plan.csv", rest)));
        break;
      default:
        readMesh(temporaryFile(data[0] % 8 == 4 ? "mesh.stl" : "mesh.obj", rest));
    }
  } catch (const BadInput&) {
  }
  return 0;
}
