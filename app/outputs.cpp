// SPDX-License-Identifier: BSD-3-Clause
#include "outputs.h"

#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "exit_status.h"
#include "files/files.h"
#include "text/one_line.h"
#include "world.h"

namespace fcl_artic::app {
namespace {

namespace fs = std::filesystem;

/// The same file on the disk, or the same name of one that is not there yet.
bool areSame(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  const fs::path resolved_a = fs::weakly_canonical(files::targetOf(a), error),
                 resolved_b = fs::weakly_canonical(files::targetOf(b), error);
  return !resolved_a.empty() && resolved_a == resolved_b;  // empty: it can't be resolved
}

std::vector<std::string> filesIn(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {path};
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(path, error)) files.push_back(entry.path().string());
  return files;
}

bool isRegular(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

}  // namespace

void removeEarlierOutputs(const std::vector<Output>& outputs, const std::vector<std::string>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const Output& output = outputs[i];
    if (output.path->empty()) continue;
    for (std::size_t k = 0; k < i; ++k) {
      if (outputs[k].path->empty() || !areSame(*output.path, *outputs[k].path)) continue;
      if (fs::exists(*output.path) && !isRegular(*output.path)) continue;  // /dev/null takes any number
      throw std::invalid_argument(
          fmt::format("{} and {} name one file: '{}'", outputs[k].option, output.option, *output.path));
    }
    if (fs::is_directory(*output.path)) {
      throw std::invalid_argument(fmt::format("{} '{}': is a directory, not a file", output.option, *output.path));
    }
    if (!isRegular(*output.path)) continue;
    for (const std::string& input : inputs) {
      for (const std::string& file : filesIn(input)) {
        if (areSame(*output.path, file)) {
          throw std::invalid_argument(
              fmt::format("{} '{}' is a file that this run reads: choose another name", output.option, *output.path));
        }
      }
    }
  }
  for (const Output& output : outputs) {
    if (output.path->empty() || !isRegular(*output.path)) continue;
    std::error_code error;
    fs::remove(files::targetOf(*output.path), error);
    if (error) {
      throw std::runtime_error(fmt::format("{} '{}': an earlier run's file can't be removed: {}", output.option,
                                           *output.path, error.message()));
    }
  }
}

int UnwrittenOutputs::exitStatus(int status) const {
  for (const std::string& reason : reasons_) fmt::print(stderr, "fcl_artic: error: {}\n", reason);
  return reasons_.empty() ? status : kExitError;
}

void printNotes(const std::vector<std::string>& notes, const std::string& of) {
  for (const std::string& note : notes) {
    fmt::print(stderr, "fcl_artic: note: {}{}{}\n", text::oneLine(of), of.empty() ? "" : ": ", text::oneLine(note));
  }
}

std::vector<std::string> inputsOf(const WorldOptions& options) {
  std::vector<std::string> files = options.scenes;
  for (const std::string& file : {options.robot.robot, options.robot.srdf, options.pairs.margins}) {
    if (!file.empty()) files.push_back(file);
  }
  for (const std::string& text : options.robot.attached) {  // LINK=FILE@POSE
    const std::size_t begin = text.find('=') + 1;
    files.push_back(text.substr(begin, text.rfind('@') - begin));
  }
  return files;
}

}  // namespace fcl_artic::app
