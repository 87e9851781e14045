// SPDX-License-Identifier: BSD-3-Clause
//
// The folder of a run of `certify --edges`: run.json says what it is about, blocks/ has the answers, a file for each
// block. A block's file appears as a whole or not at all, so that the files that are there are the checkpoint.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "edges/columns.h"

namespace fcl_artic::app {

/// Rows of one scene.
struct Segment {
  std::size_t scene = 0, begin = 0, count = 0;  ///< edges [begin, begin + count)
};

/// How scenes and edges are cut into blocks of at most `block_rows` edges. A block has one scene, except where each
/// edge has a scene of its own.
struct Cut {
  std::size_t scenes = 1, edges = 0, block_rows = 1;
  bool scene_of_edge = false;

  std::size_t blocksPerScene() const { return (edges + block_rows - 1) / block_rows; }
  std::size_t blocks() const { return blocksPerScene() * (scene_of_edge ? 1 : scenes); }
  std::size_t rows() const { return edges * (scene_of_edge ? 1 : scenes); }
  std::size_t sceneOf(std::size_t block) const { return scene_of_edge ? 0 : block / blocksPerScene(); }
  std::size_t begin(std::size_t block) const { return block % blocksPerScene() * block_rows; }
  std::size_t count(std::size_t block) const { return std::min(block_rows, edges - begin(block)); }
};

/// A block that can't be used: named, with what to do.
class DamagedBlock : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A block as its file holds it.
struct Block {
  Columns rows;        ///< empty where only the summary was read
  Counts counts;       ///< of the rows
  std::string sha256;  ///< hashOf(rows)
};

/// How much of a block's file is read.
enum class Read {
  rows,    ///< all of it, and its summary is checked against the rows
  summary  ///< counts and hash as the file says them
};

class RunFolder {
 public:
  /// A run that begins or goes on.
  /// @param run  what it is about. Its hash marks each block.
  /// @throws std::invalid_argument naming what differs from the run that the folder is of; std::runtime_error naming
  ///   the file.
  RunFolder(std::string folder, const nlohmann::ordered_json& run);
  /// A run that is there.
  /// @throws std::runtime_error naming the file.
  explicit RunFolder(std::string folder);

  const nlohmann::ordered_json& run() const { return run_; }
  Cut cut() const;
  bool certificates() const { return run_.at("request").at("certificates"); }
  std::string blockPath(std::size_t block) const;
  std::string blockName(std::size_t block) const;  ///< relative to the folder
  std::string certificatePath(std::size_t block) const;
  std::string worldPath(std::size_t scene) const;

  /// A block that is finished; nothing of one that isn't there.
  /// @throws DamagedBlock naming the file and the cure: of another run, not whole, or not what was written.
  std::optional<Block> readBlock(std::size_t block, Read what = Read::rows) const;
  /// @param records  of certificates, a file of their own; the block's names its hash.
  /// @throws std::runtime_error naming the file.
  void writeBlock(std::size_t block, const Columns& rows, const std::string& records) const;

  /// Writes the table of all blocks (table.h5, a virtual one) and summary.json; both name the hash of all rows.
  /// @param partial  blocks that are missing are no error: their rows say so.
  /// @param what     Read::summary if the caller has written all blocks or read their rows: all ranks wait while one
  ///   process is here.
  /// @return the summary.
  /// @throws std::runtime_error naming blocks that are missing or damaged.
  nlohmann::ordered_json merge(bool partial, Read what = Read::rows) const;

  const std::string& path() const { return folder_; }

 private:
  std::string folder_;
  nlohmann::ordered_json run_;
  std::string hash_;
};

}  // namespace fcl_artic::app
