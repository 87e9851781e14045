// SPDX-License-Identifier: BSD-3-Clause
// fcl_artic_verify: proves the claims of certificates again. See doc/CERTIFICATES.md.
#include <cstdio>
#include <cstdlib>

#include "proof.h"
#include "readers.h"

namespace {

constexpr const char* kHelp =
    R"(fcl_artic_verify [options] WORLD [CERTIFICATES...]

Proves again what certificates claim: that along a motion no two bodies that are checked come nearer than their margin.
Uses integers, GMP and MPFR; shares nothing with the library that wrote the certificates. doc/CERTIFICATES.md says what
is claimed, and how it is proven.

  WORLD            the world's text
  CERTIFICATES     files of records

  --urdf FILE      compare the world with a URDF: frames, joints, collision geometry (shapes, STL, OBJ)
  --package N=DIR  the folder of "package://N/" in the URDF
  --srdf FILE      compare pairs that the world allows to touch with an SRDF
  --json           print each record's motion and proof as JSON, and the verdict
  --quiet          print no line for what is verified
  --work N         limit of work per record, in steps of roughly 20 ns (default 2000000000)
  --help, --version

Prints a line per record: VERIFIED, with the number of pairs that were checked and of those that were not, by reason; or
NOT VERIFIED, with what could not be proven: bodies and interval of time.
Exit: 0 all verified, 1 something is not or the world differs from a file, 2 bad input.
)";

/// A text that may hold names: what is no printing character as \xNN, so that no name can look like a line of this
/// program.
std::string shown(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    char escape[8];
    std::snprintf(escape, sizeof escape, byte < 32 || byte > 126 ? "\\x%02x" : "%c", byte);
    safe += escape;
  }
  return safe;
}

/// @return whether the world is what the file says.
bool report(const char* path, const verify::Comparison& comparison) {
  for (const std::string& note : comparison.notes) std::printf("%s: %s\n", path, shown(note).c_str());
  for (const std::string& what : comparison.differences) std::printf("%s: DIFFERENT: %s\n", path, shown(what).c_str());
  return comparison.differences.empty();
}

void printJson(const verify::World& world, const verify::Record& record) {
  try {
    std::printf("%s\n", verify::proofAsJson(world, record).c_str());
  } catch (const verify::BadInput& error) {  // the verdict says why, too
    std::printf("null\n");
  }
}

void print(const verify::Verdict& v) {
  std::printf("VERIFIED %llu pairs", static_cast<unsigned long long>(v.checked));
  if (v.late > 0) std::printf(" (%llu not before they part)", static_cast<unsigned long long>(v.late));
  if (v.pieces > 1) std::printf(", %zu pieces", v.pieces);
  if (v.until < 1) std::printf(", until t = %.17g", v.until);
  const char* before = "; not checked: ";
  for (int k = 0; k < verify::kReasons; ++k) {
    if (v.not_checked[k] == 0) continue;
    std::printf("%s%llu %s", before, static_cast<unsigned long long>(v.not_checked[k]),
                verify::nameOf(static_cast<verify::Reason>(k)));
    before = ", ";
  }
  if (v.contact) std::printf("; CONTACT of %s", shown(v.contact_text).c_str());
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  bool json = false, quiet = false;
  verify::Options options;
  std::vector<const char*> files, urdf, srdf;
  std::map<std::string, std::string> packages;
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
  if (files.empty() || (files.size() == 1 && urdf.empty() && srdf.empty())) {
    std::fprintf(stderr, "fcl_artic_verify: a world and certificates are needed (see --help)\n");
    return 2;
  }
  std::size_t verified = 0, all = 0;
  bool bad = false, same = true;
  try {
    const std::string world_text = verify::readFile(files[0]);
    const verify::World world = verify::readWorld(world_text);
    for (const char* path : urdf) same = report(path, verify::compareWithUrdf(world, path, packages)) && same;
    for (const char* path : srdf) same = report(path, verify::compareWithSrdf(world, path)) && same;
    for (std::size_t f = 1; f < files.size(); ++f) {
      const std::string bytes = verify::readFile(files[f]);
      std::size_t number = 0;
      for (const verify::Record& record : verify::splitRecords(bytes)) {
        const verify::Verdict verdict = verify::verifyRecord(world, record, options);
        ++all;
        verified += verdict.verified;
        bad = bad || verdict.bad_input;
        if (json) printJson(world, record);
        if (!verdict.verified || !quiet) std::printf("%s:%zu: ", files[f], number);
        if (!verdict.verified) std::printf("NOT VERIFIED: %s\n", shown(verdict.reason).c_str());
        if (verdict.verified && !quiet) print(verdict);
        ++number;
      }
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fcl_artic_verify: %s\n", shown(error.what()).c_str());
    return 2;
  }
  std::printf("%zu of %zu records verified\n", verified, all);
  return bad ? 2 : verified == all && same ? 0 : 1;
}
