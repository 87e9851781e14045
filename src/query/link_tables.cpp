// SPDX-License-Identifier: BSD-3-Clause
#include "query/link_tables.h"

#include <algorithm>

namespace fcl_artic {

LinkTables::Made::Made(const ManagedBody& a, const ManagedBody& b, double margin)
    : shape_a(a.shape), shape_b(b.shape), link_a(a.link), link_b(b.link), offset_a(a.offset.matrix()),
      offset_b(b.offset.matrix()), margin(margin) {}

bool LinkTables::Made::sameMaking(const Made& other) const {
  return shape_a == other.shape_a && shape_b == other.shape_b && link_a == other.link_a && link_b == other.link_b &&
         offset_a == other.offset_a && offset_b == other.offset_b && margin == other.margin;
}

void LinkTables::build(const Registry& registry, const engine::Problem& problem, std::size_t num_self_pairs) {
  std::vector<Made> before;
  std::swap(made_, before);
  tables_.clear();
  for (std::size_t i = 0; i < num_self_pairs; ++i) {
    const engine::LinkPair& pair = problem.link_pairs[i];
    const ManagedBody &a = registry.body(pair.a), &b = registry.body(pair.b);
    if (a.attached || b.attached) continue;
    Made made(a, b, problem.link_margins ? std::max(0.0, problem.link_margins[i]) : 0);
    const auto known = std::find_if(before.begin(), before.end(), [&](const Made& m) { return m.sameMaking(made); });
    made.table = known != before.end() ? known->table
                                       : PairTable::build(*registry.tree(), problem.sweeps[pair.sweep], problem.bodies,
                                                          pair, made.margin);
    if (made.table) tables_.emplace_back(i, made.table);
    made_.push_back(std::move(made));
  }
}

const std::uint8_t* LinkTables::freeParts(const engine::Problem& problem, const JointMotion& motion, double margin,
                                          std::vector<std::uint8_t>& memory) const {
  memory.assign(static_cast<std::size_t>(problem.num_link_pairs), 0);
  for (const auto& [pair, table] : tables_) {
    const auto number = problem.num_scene_pairs + static_cast<std::int32_t>(pair);
    if (engine::marginOf(problem, margin, number) > table->margin()) continue;
    memory[pair] = static_cast<std::uint8_t>(table->freeParts(motion.variables()));
  }
  return memory.data();
}

}  // namespace fcl_artic
