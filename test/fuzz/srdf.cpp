// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/urdf/urdf.h"
#include "fuzz.h"

using namespace fcl_artic;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const KinematicTree tree = [] {
    KinematicTree all("r");
    for (const char* link : {"a", "b", "c", "d"}) all.addLink(link);
    return all;
  }();
  const std::string path =
      fuzz::Folder::instance().write("robot.srdf", std::string(reinterpret_cast<const char*>(data), size));
  AllowedCollisionMatrix matrix;
  if (!fuzz::loads(path, [&] { matrix = loadSrdf(path, tree); })) return 0;
  LinkPairReport pairs;
  for (const auto& [a, b] : matrix.pairs()) {
    LinkPairFinding& pair = pairs.pairs.emplace_back();
    pair.link1 = a;
    pair.link2 = b;
    pair.kind = LinkPairKind::never;
  }
  writeSrdf(path, "r", pairs);
  if (loadSrdf(path, tree).pairs() != matrix.pairs()) fuzz::fault("pairs that were written are not those read back");
  return 0;
}
