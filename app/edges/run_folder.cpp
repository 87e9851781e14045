// SPDX-License-Identifier: BSD-3-Clause
#include "edges/run_folder.h"

#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "certificate/sha256.h"
#include "files/files.h"

namespace fcl_artic::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "fcl-artic-edges/2";

std::string textOf(const Json& json) {
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

/// The first value in which they differ, by its keys; empty where they are the same.
std::string differenceOf(const Json& before, const Json& now, const std::string& at = "") {
  if (before == now) return {};
  if (before.is_object() && now.is_object()) {
    for (const auto& [key, value] : now.items()) {
      const std::string found = before.contains(key)
                                    ? differenceOf(before.at(key), value, at.empty() ? key : at + "." + key)
                                    : fmt::format("'{}' is new", key);
      if (!found.empty()) return found;
    }
    return fmt::format("something of '{}' is gone", at);
  }
  return fmt::format("'{}' was {} and is {}", at, before.dump(), now.dump());
}

void makeFolder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw std::runtime_error(fmt::format("cannot make the folder '{}': {}", path, error.message()));
}

/// Counts as JSON says them, and back.
void put(const Counts& counts, Json& to) {
  for (std::int8_t s = 0; s < kNumRowStatuses; ++s) to[toString(static_cast<RowStatus>(s))] = counts.of[s];
  to["contact_uncertain"] = counts.uncertain;
  to["free_with_ignored_initial_contacts"] = counts.with_ignored;
  to["free_with_never_apart_pairs"] = counts.with_never_apart;
  to["free_with_unproven_allowed_pairs"] = counts.with_unproven;
}
Counts countsOf(const Json& json) {
  Counts counts;
  for (std::int8_t s = 0; s < kNumRowStatuses; ++s) counts.of[s] = json.at(toString(static_cast<RowStatus>(s)));
  counts.uncertain = json.at("contact_uncertain");
  counts.with_ignored = json.at("free_with_ignored_initial_contacts");
  counts.with_never_apart = json.at("free_with_never_apart_pairs");
  counts.with_unproven = json.at("free_with_unproven_allowed_pairs");
  return counts;
}
Json jsonOf(const Counts& counts) {
  Json json;
  put(counts, json);
  return json;
}

Json parse(const std::string& path) {
  const std::string content = files::read(path);
  try {
    Json run = Json::parse(content);
    if (run.at("format") != kFormat)
      throw std::runtime_error(fmt::format("its format is {}, not {}", run.at("format").dump(), kFormat));
    return run;
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("'{}': {}", path, error.what()));
  }
}

}  // namespace

RunFolder::RunFolder(std::string folder, const Json& run) : folder_(std::move(folder)) {
  run_["format"] = kFormat;
  run_.update(run);
  const std::string path = folder_ + "/run.json", text = textOf(run_);
  hash_ = certificate::sha256Text(text);
  makeFolder(folder_ + "/blocks");
  if (certificates()) makeFolder(folder_ + "/certificates");
  if (fs::exists(path)) {
    const Json before = parse(path);
    const std::string difference = differenceOf(before, run_);
    if (difference.empty()) return;
    throw std::invalid_argument(fmt::format(
        "'{}' is of another run: {}; give the same inputs to go on with it, or another --out", folder_, difference));
  }
  files::write(path, text);
}

RunFolder::RunFolder(std::string folder) : folder_(std::move(folder)), run_(parse(folder_ + "/run.json")) {
  hash_ = certificate::sha256Text(textOf(run_));
}

Cut RunFolder::cut() const {
  const Json& cut = run_.at("cut");
  return {cut.at("scenes"), cut.at("edges"), cut.at("block_rows"), cut.at("scene_of_edge")};
}

std::string RunFolder::blockName(std::size_t block) const {
  return fmt::format("blocks/block-{:07}.h5", block);
}
std::string RunFolder::blockPath(std::size_t block) const {
  return folder_ + "/" + blockName(block);
}
std::string RunFolder::certificatePath(std::size_t block) const {
  return fmt::format("{}/certificates/block-{:07}.fac", folder_, block);
}
std::string RunFolder::worldPath(std::size_t scene) const {
  return fmt::format("{}/certificates/scene-{:07}.world", folder_, scene);
}

std::optional<Block> RunFolder::readBlock(std::size_t block, Read what) const {
  const std::string path = blockPath(block);
  if (!fs::exists(path)) return std::nullopt;
  const auto damaged = [&](const std::string& why) -> DamagedBlock {
    return DamagedBlock(
        fmt::format("block {} is damaged: {}; remove '{}' and run again, only it is computed anew", block, why, path));
  };
  const std::size_t count = cut().count(block);
  Block read;
  try {
    const hdf5::File file(files::read(path), path);
    const auto text = [&](const char* name) {
      const std::vector<std::string> values = file.strings("", name);
      return values.size() == 1 ? values[0] : std::string();
    };
    if (text("run") != hash_) throw std::runtime_error(fmt::format("'{}': it is of another run", path));
    if (text("block") != std::to_string(block))
      throw std::runtime_error(fmt::format("'{}': it is block {}", path, text("block")));
    read.sha256 = text("sha256");
    read.counts = countsOf(Json::parse(text("counts")));
    if (read.counts.rows() != count) throw std::runtime_error(fmt::format("'{}': it has not {} rows", path, count));
    if (what == Read::summary) return read;
    if (certificates() && text("certificates_sha256") != certificate::sha256Text(files::read(certificatePath(block))))
      throw std::runtime_error(fmt::format("'{}': is of another run of this block", certificatePath(block)));
    read.rows.assign(count, certificates());
    std::vector<double> doubles;
    std::vector<std::int64_t> numbers;
    forEachColumn(read.rows, [&](const char* name, hdf5::Type type, auto& values) {
      if (file.shape(name) != std::vector<std::size_t>{count}) {
        throw std::runtime_error(fmt::format("'{}': column '{}' has not {} rows", path, name, count));
      }
      using T = typename std::decay_t<decltype(values)>::value_type;
      if (type == hdf5::Type::float64) {
        file.read(name, 0, count, doubles);
        for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<T>(doubles[i]);
      } else {
        file.read(name, 0, count, numbers);
        for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<T>(numbers[i]);
      }
    });
  } catch (const std::exception& error) {
    throw damaged(error.what());
  }
  if (hashOf(read.rows) != read.sha256)
    throw damaged("its rows are not those that were written, their SHA-256 differs");
  for (const std::int8_t status : read.rows.status) {
    if (status <= 0 || status >= kNumRowStatuses) throw damaged(fmt::format("a row has the status {}", status));
  }
  Counts counts;
  counts.add(read.rows);
  if (jsonOf(counts) != jsonOf(read.counts)) throw damaged("its counts are not those of its rows");
  return read;
}

void RunFolder::writeBlock(std::size_t block, const Columns& rows, const std::string& records) const {
  hdf5::Image image;
  forEachColumn(
      rows, [&](const char* name, hdf5::Type, const auto& values) { image.add(name, {values.size()}, values.data()); });
  image.attribute("", "format", kFormat);
  image.attribute("", "run", hash_);
  image.attribute("", "block", std::to_string(block));
  image.attribute("", "sha256", hashOf(rows));
  if (certificates()) image.attribute("", "certificates_sha256", certificate::sha256Text(records));
  Counts counts;
  counts.add(rows);
  image.attribute("", "counts", jsonOf(counts).dump());
  const std::string bytes = image.bytes();
  std::vector<files::File> together{{blockPath(block), bytes}};
  if (certificates()) together.insert(together.begin(), {certificatePath(block), records});
  files::writeTogether(together);
}

Json RunFolder::merge(bool partial, Read what) const {
  const Cut cut = this->cut();
  Counts all;
  std::vector<Counts> by_scene(cut.scene_of_edge ? 0 : cut.scenes);
  std::vector<std::size_t> missing, finished;
  std::vector<std::string> damaged;
  std::string hashes;
  for (std::size_t block = 0; block < cut.blocks(); ++block) {
    try {
      const std::optional<Block> read = readBlock(block, what);
      if (!read) {
        missing.push_back(block);
        hashes += "missing\n";
        continue;
      }
      all.add(read->counts);
      if (!cut.scene_of_edge) by_scene[cut.sceneOf(block)].add(read->counts);
      finished.push_back(block);
      hashes += read->sha256 + "\n";
    } catch (const DamagedBlock& error) {
      damaged.push_back(error.what());
    }
  }
  const auto listed = [](const std::vector<std::size_t>& blocks) {
    constexpr std::size_t kShown = 10;
    std::string text;
    for (std::size_t i = 0; i < std::min(kShown, blocks.size()); ++i)
      text += fmt::format("{}{}", i ? ", " : "", blocks[i]);
    return text + (blocks.size() > kShown ? ", ..." : "");
  };
  if (!damaged.empty()) {
    std::string text = damaged.front();
    if (damaged.size() > 1) text += fmt::format("\nand {} more, the next: {}", damaged.size() - 1, damaged[1]);
    throw std::runtime_error(text);
  }
  if (!missing.empty() && !partial) {
    throw std::runtime_error(
        fmt::format("'{}': {} of {} blocks are missing: {}; run on, or merge what is there with --partial", folder_,
                    missing.size(), cut.blocks(), listed(missing)));
  }
  all.of[0] = cut.rows() - all.rows();

  hdf5::Image table;
  const std::vector<std::size_t> shape =
      cut.scene_of_edge ? std::vector<std::size_t>{cut.edges} : std::vector<std::size_t>{cut.scenes, cut.edges};
  std::vector<hdf5::Source> sources;
  for (const std::size_t block : finished)
    sources.push_back({blockName(block), cut.sceneOf(block), cut.begin(block), cut.count(block)});
  Columns blank;
  blank.assign(1, certificates());
  forEachColumn(blank, [&](const char* name, hdf5::Type type, const auto& values) {
    table.addVirtual(name, type, shape, static_cast<double>(values[0]), sources);
  });
  std::vector<std::string> statuses;
  for (std::int8_t s = 0; s < kNumRowStatuses; ++s) statuses.push_back(toString(static_cast<RowStatus>(s)));
  table.attribute("status", "values", statuses);
  table.attribute("", "format", kFormat);
  table.attribute("", "links", run_.at("robot").at("links").get<std::vector<std::string>>());
  const std::string rows_hash = certificate::sha256Text(hashes);
  table.attribute("", "sha256", rows_hash);

  Json summary = {{"format", kFormat},  {"run", hash_},           {"table_sha256", rows_hash},
                  {"rows", cut.rows()}, {"blocks", cut.blocks()}, {"missing_blocks", missing.size()}};
  put(all, summary);
  constexpr std::size_t kScenesShown = 10000;
  if (!by_scene.empty() && by_scene.size() <= kScenesShown) {
    Json& scenes = summary["scenes"] = Json::array();
    for (std::size_t s = 0; s < by_scene.size(); ++s) {
      by_scene[s].of[0] = cut.edges - by_scene[s].rows();
      Json& scene = scenes.emplace_back(
          Json{{"name", run_.at("scenes").contains("names") ? run_.at("scenes").at("names").at(s) : Json(s)}});
      put(by_scene[s], scene);
    }
  }
  const std::string bytes = table.bytes(), text = textOf(summary);
  files::writeTogether({{folder_ + "/table.h5", bytes}, {folder_ + "/summary.json", text}});
  if (missing.empty()) {
    // Files that killed ranks have left behind.
    for (const char* part : {"/blocks", "/certificates"}) {
      std::error_code none;
      for (const auto& entry : fs::directory_iterator(folder_ + part, none)) {
        if (entry.path().filename().string().find(".part") != std::string::npos) fs::remove(entry.path(), none);
      }
    }
  }
  return summary;
}

}  // namespace fcl_artic::app
