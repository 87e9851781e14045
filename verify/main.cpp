// SPDX-License-Identifier: BSD-3-Clause
// fcl_artic_verify: proves the claims of certificates again. See doc/CERTIFICATES.md.
#include <cstdio>
#include <cstdlib>

#include "readers.h"
#include "report.h"

namespace {

constexpr const char* kHelp =
    R"(fcl_artic_verify [options] WORLD CERTIFICATES...

Proves again what certificates claim: that along a motion no two bodies that are checked come nearer than their margin.
Uses integers, GMP and MPFR; shares nothing with the library that wrote the certificates. doc/CERTIFICATES.md says what
is claimed, and how it is proven.

  WORLD            the world's text
  CERTIFICATES     files of records

  --urdf FILE      compare the world with a URDF: frames, joints, collision geometry (shapes, STL, OBJ)
  --package N=DIR  the folder of "package://N/" in the URDF
  --solid-meshes   meshes of the URDF are meant as solids; without, as surfaces or solids
  --solid LINK     those of this link are
  --srdf FILE      compare pairs that the world does not check with an SRDF
  --compare-only   no certificates: only compare the world with the files
  --json           print everything as JSON, and each record's motion and proof
  --quiet          print no line for what is verified, and none about the world
  --work N         limit of work per record, in steps of roughly 20 ns (default 2000000000)
  --help, --version

Prints what the world says beside its numbers, and for each record VERIFIED, with the number of pairs that were checked
and of those that were not, by reason, then what the motion says; or NOT VERIFIED, with what could not be proven: bodies
and interval of time. A claim about no pair is not verified, nor one about a world that differs from --urdf or --srdf.
Exit: 0 all verified, 1 something is not or the world differs from a file, 2 bad input, or no record.
)";

/// Prints what the program says, in text or as JSON: a document a line or more, one after the other.
class Printer {
 public:
  Printer(bool json, bool quiet) : json_(json), quiet_(quiet) {}

  void comparison(const char* path, const verify::Comparison& c) const {
    if (json_) {
      std::printf("{\"file\": %s, \"notes\": %s, \"different\": %s}\n", verify::quotedJson(path).c_str(),
                  verify::listAsJson(c.notes).c_str(), verify::listAsJson(c.differences).c_str());
      return;
    }
    for (const std::string& note : c.notes) line(path, note);
    for (const std::string& what : c.differences) line(path, "DIFFERENT: " + what);
  }
  void world(const char* path, const verify::World& world) const {
    const std::vector<std::string> lines = verify::linesOf(world);
    if (json_)
      std::printf("{\"world\": %s, \"says\": %s}\n", verify::quotedJson(path).c_str(),
                  verify::listAsJson(lines).c_str());
    if (json_ || quiet_) return;
    for (const std::string& text : lines) line(path, text);
  }
  void record(const verify::World& world, const char* path, std::size_t number, const verify::Record& record,
              const verify::Verdict& verdict) const {
    std::vector<std::string> lines;
    if (verdict.verified) lines = verify::linesOf(world, verify::readMotion(record.motion, world), verdict);
    if (json_) {
      std::string statement = "null";
      try {
        statement = verify::proofAsJson(world, record);
      } catch (const verify::BadInput&) {  // the verdict says why, too
      }
      std::printf("{\"file\": %s, \"record\": %zu, \"verdict\": %s, \"says\": %s,\n\"statement\": %s}\n",
                  verify::quotedJson(path).c_str(), number, verify::verdictAsJson(verdict).c_str(),
                  verify::listAsJson(lines).c_str(), statement.c_str());
      return;
    }
    if (quiet_ && verdict.verified) return;
    std::printf("%s:%zu: %s\n", verify::shown(path).c_str(), number, verify::lineOf(verdict).c_str());
    for (const std::string& text : lines) std::printf("  %s\n", verify::shown(text).c_str());
  }
  void sum(std::size_t verified, std::size_t all) const {
    std::printf(json_ ? "{\"verified\": %zu, \"records\": %zu}\n" : "%zu of %zu records verified\n", verified, all);
  }

 private:
  static void line(const char* path, const std::string& text) {
    std::printf("%s: %s\n", verify::shown(path).c_str(), verify::shown(text).c_str());
  }
  const bool json_, quiet_;
};

}  // namespace

int main(int argc, char** argv) {
  bool json = false, quiet = false, compare_only = false;
  verify::Options options;
  std::vector<const char*> files, urdf, srdf;
  std::map<std::string, std::string> packages;
  verify::Solids solids;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--help") {
      std::fputs(kHelp, stdout);
      return 0;
    } else if (word == "--version") {
      std::puts("fcl_artic_verify 1");
      return 0;
    } else if (word == "--json") {
      json = true;
    } else if (word == "--solid-meshes") {
      solids.all = true;
    } else if (word == "--solid" && k + 1 < argc) {
      solids.links.insert(argv[++k]);
    } else if (word == "--compare-only") {
      compare_only = true;
    } else if (word == "--quiet") {
      quiet = true;
    } else if (word == "--urdf" && k + 1 < argc) {
      urdf.push_back(argv[++k]);
    } else if (word == "--srdf" && k + 1 < argc) {
      srdf.push_back(argv[++k]);
    } else if (word == "--package" && k + 1 < argc) {
      const std::string both = argv[++k];
      const std::size_t equals = both.find('=');
      if (equals == std::string::npos) {
        std::fprintf(stderr, "fcl_artic_verify: --package takes NAME=FOLDER\n");
        return 2;
      }
      packages[both.substr(0, equals)] = both.substr(equals + 1);
    } else if (word == "--work" && k + 1 < argc) {
      options.work = std::strtoull(argv[++k], nullptr, 10);
    } else if (word.size() > 1 && word[0] == '-') {
      std::fprintf(stderr, "fcl_artic_verify: unknown option '%s' (see --help)\n", argv[k]);
      return 2;
    } else {
      files.push_back(argv[k]);
    }
  }
  if (compare_only ? files.size() != 1 || (urdf.empty() && srdf.empty()) : files.size() < 2) {
    std::fprintf(stderr, compare_only
                             ? "fcl_artic_verify: --compare-only takes a world, no certificates, and --urdf or --srdf\n"
                             : "fcl_artic_verify: a world and certificates are needed (see --help)\n");
    return 2;
  }
  if ((solids.all || !solids.links.empty()) && urdf.empty()) {
    std::fprintf(stderr, "fcl_artic_verify: --solid and --solid-meshes say how --urdf is meant\n");
    return 2;
  }
  std::size_t verified = 0, all = 0;
  bool bad = false, same = true;
  const Printer printer(json, quiet);
  try {
    const std::string world_text = verify::readFile(files[0]);
    const verify::World world = verify::readWorld(world_text);
    const auto report = [&](const char* path, const verify::Comparison& comparison) {
      printer.comparison(path, comparison);
      same = same && comparison.differences.empty();
    };
    for (const char* path : urdf) report(path, verify::compareWithUrdf(world, path, packages, solids));
    for (const char* path : srdf) report(path, verify::compareWithSrdf(world, path));
    printer.world(files[0], world);
    for (std::size_t f = 1; f < files.size(); ++f) {
      const std::string bytes = verify::readFile(files[f]);
      const std::vector<verify::Record> records = verify::splitRecords(bytes);
      if (records.empty()) throw verify::BadInput("'" + std::string(files[f]) + "' has no record: nothing is proven");
      for (std::size_t number = 0; number < records.size(); ++number) {
        verify::Verdict verdict = verify::verifyRecord(world, records[number], options);
        if (!same && verdict.verified) {  // proven of another robot
          verdict.verified = false;
          verdict.reason = "it is proven of this world, which is not what the files say (DIFFERENT, above)";
        }
        ++all;
        verified += verdict.verified;
        bad = bad || verdict.bad_input;
        printer.record(world, files[f], number, records[number], verdict);
      }
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fcl_artic_verify: %s\n", verify::shown(error.what()).c_str());
    return 2;
  }
  if (!compare_only) printer.sum(verified, all);
  return bad ? 2 : verified == all && same ? 0 : 1;
}
