// SPDX-License-Identifier: BSD-3-Clause
#include "edges/ranks.h"

#include <dlfcn.h>

#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "edges/mpi_plugin.h"

namespace fcl_artic::app {
namespace {

namespace fs = std::filesystem;

class Shard : public Ranks {
 public:
  Shard(std::int64_t first, std::int64_t step) : next_(first), step_(step) {}
  std::int64_t next() override {
    const std::int64_t taken = next_;
    next_ += step_;
    return taken;
  }
  double share() const override { return 1 / static_cast<double>(step_); }
  std::int64_t addDone(std::int64_t rows) override { return done_ += rows; }
  int finish(int status, int& first) override { return first = status; }

 private:
  std::int64_t next_, step_, done_ = 0;
};

std::unique_ptr<Ranks> shardOf(const std::string& text) {
  std::int64_t i = 0, n = 0;
  const char* const end = text.data() + text.size();
  auto [at, error] = std::from_chars(text.data(), end, i);
  bool good = error == std::errc() && at != end && *at == '/';
  if (good) {
    const auto second = std::from_chars(at + 1, end, n);
    good = second.ec == std::errc() && second.ptr == end;
  }
  if (!good || i < 1 || i > n) {
    throw std::invalid_argument(fmt::format("--shard '{}': not I/N, shard I of N, I from 1 to N", text));
  }
  return std::make_unique<Shard>(i - 1, n);
}

/// A program that starts MPI's processes sets one of these in their environment.
const char* startedByMpi() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"}) {
    if (std::getenv(name)) return name;
  }
  return nullptr;
}

/// Beside the program, as it is built, or where it is installed.
std::string pluginPath() {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& path :
       {folder / FCL_ARTIC_MPI_PLUGIN, folder / FCL_ARTIC_PLUGIN_FOLDER / FCL_ARTIC_MPI_PLUGIN}) {
    if (fs::exists(path, error)) return path.string();
  }
  return {};
}

class MpiRanks : public Ranks {
 public:
  explicit MpiRanks(const char* sign) {
    const std::string path = pluginPath();
    const auto fail = [&](const std::string& why) {
      throw std::runtime_error(
          fmt::format("this process was started as a rank of an MPI job ({} is set), but {}; --shard I/N shares the "
                      "work out without MPI",
                      sign, why));
    };
    if (path.empty()) fail("the program's plug-in " FCL_ARTIC_MPI_PLUGIN " is not there: it was built without MPI");
    void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL);  // stays: MPI doesn't like to be unloaded
    if (!library) fail(fmt::format("'{}' can't be loaded: {}", path, dlerror()));
    const auto open = reinterpret_cast<decltype(&fcl_artic_mpi)>(dlsym(library, "fcl_artic_mpi"));
    mpi_ = open ? open() : nullptr;
    if (!mpi_) fail(fmt::format("'{}' is of another version", path));
    char why[256] = "";
    if (mpi_->open(why, sizeof why) != 0) fail(why);
  }
  ~MpiRanks() override { mpi_->close(); }
  int rank() const override { return mpi_->rank(); }
  int size() const override { return mpi_->size(); }
  std::int64_t next() override { return mpi_->add(0, 1); }
  std::int64_t addDone(std::int64_t rows) override { return mpi_->add(1, rows) + rows; }
  int finish(int status, int& first) override { return mpi_->finish(status, &first); }

 private:
  const FclArticMpi* mpi_ = nullptr;
};

}  // namespace

std::unique_ptr<Ranks> openRanks(const std::string& shard) {
  if (!shard.empty()) return shardOf(shard);
  if (const char* const sign = startedByMpi()) return std::make_unique<MpiRanks>(sign);
  return std::make_unique<Shard>(0, 1);
}

}  // namespace fcl_artic::app
