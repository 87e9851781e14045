// SPDX-License-Identifier: BSD-3-Clause
//
// Identity of a pair of bodies within a problem. A number of its own type: no index of a body, a mover, a link pair or
// an entry of a list passes for it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace fcl_artic {
namespace engine {

/// Scene pairs come first, by mover and obstacle, then the link pairs. Problem::parts says what one stands for.
enum class PairId : std::int32_t {};

constexpr PairId kNoPair{-1};

/// Its place in an array with an entry for each pair of the problem.
[[gnu::always_inline]] constexpr std::size_t indexOf(PairId pair) {
  return static_cast<std::size_t>(pair);
}

/// The first pairs of a problem, to loop over.
struct PairRange {
  std::int32_t count;

  struct Iterator {
    std::int32_t at;
    [[gnu::always_inline]] PairId operator*() const { return PairId{at}; }
    [[gnu::always_inline]] Iterator& operator++() {
      ++at;
      return *this;
    }
    [[gnu::always_inline]] bool operator!=(const Iterator& other) const { return at != other.at; }
  };
  [[gnu::always_inline]] Iterator begin() const { return {0}; }
  [[gnu::always_inline]] Iterator end() const { return {count}; }
};

/// Where scene pairs end and link pairs begin. The arithmetic of pairs is here. (Inlined always: each instruction set
/// has its own.)
struct PairNumbering {
  std::int32_t num_scene_pairs = 0, num_obstacles = 0;

  [[gnu::always_inline]] bool isScenePair(PairId pair) const {
    return static_cast<std::int32_t>(pair) < num_scene_pairs;
  }
  [[gnu::always_inline]] PairId scenePair(std::int32_t mover, std::int32_t obstacle) const {
    return PairId{mover * num_obstacles + obstacle};
  }
  [[gnu::always_inline]] PairId linkPair(std::int32_t link_pair) const { return PairId{num_scene_pairs + link_pair}; }
  [[gnu::always_inline]] std::int32_t moverOf(PairId scene_pair) const {
    return static_cast<std::int32_t>(scene_pair) / num_obstacles;
  }
  [[gnu::always_inline]] std::int32_t obstacleOf(PairId scene_pair) const {
    return static_cast<std::int32_t>(scene_pair) % num_obstacles;
  }
  /// Index among the link pairs.
  [[gnu::always_inline]] std::int32_t linkPairOf(PairId pair) const {
    return static_cast<std::int32_t>(pair) - num_scene_pairs;
  }
  /// The entry of a pair in two arrays, one for the scene pairs and one for the link pairs; null if that array is.
  template <class T>
  [[gnu::always_inline]] T* in(T* scene, T* links, PairId pair) const {
    if (isScenePair(pair)) return scene ? scene + static_cast<std::int32_t>(pair) : nullptr;
    return links ? links + linkPairOf(pair) : nullptr;
  }
};

}  // namespace engine
}  // namespace fcl_artic
