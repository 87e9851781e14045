// SPDX-License-Identifier: BSD-3-Clause
// fcl_artic_verify: proves the claims of certificates again. See doc/CERTIFICATES.md.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "proof.h"

namespace {

constexpr const char* kHelp =
    R"(fcl_artic_verify [options] WORLD CERTIFICATES...

Proves again what certificates claim: that along a motion no two bodies that are checked come nearer than their margin.
Uses integers, GMP and MPFR; shares nothing with the library that wrote the certificates. doc/CERTIFICATES.md says what
is claimed, and how it is proven.

  WORLD            the world's text
  CERTIFICATES     files of records

  --json           print each record's motion and proof as JSON, and the verdict
  --quiet          print no line for what is verified
  --work N         limit of work per record, in steps of roughly 20 ns (default 2000000000)
  --help, --version

Prints a line per record: VERIFIED, with the number of pairs that were checked and of those that were not, by reason; or
NOT VERIFIED, with what could not be proven: bodies and interval of time.
Exit: 0 all verified, 1 something is not, 2 bad input.
)";

std::string readFile(const char* path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw verify::BadInput(std::string("can't open '") + path + "'");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
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
  if (v.pieces > 1) std::printf(", %zu pieces", v.pieces);
  if (v.until < 1) std::printf(", until t = %.17g", v.until);
  const char* before = "; not checked: ";
  for (int k = 0; k < verify::kReasons; ++k) {
    if (v.not_checked[k] == 0) continue;
    std::printf("%s%llu %s", before, static_cast<unsigned long long>(v.not_checked[k]),
                verify::nameOf(static_cast<verify::Reason>(k)));
    before = ", ";
  }
  if (v.contact) std::printf("; CONTACT of %s", v.contact_text.c_str());
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  bool json = false, quiet = false;
  verify::Options options;
  std::vector<const char*> files;
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
    } else if (word == "--work" && k + 1 < argc) {
      options.work = std::strtoull(argv[++k], nullptr, 10);
    } else if (word.size() > 1 && word[0] == '-') {
      std::fprintf(stderr, "fcl_artic_verify: unknown option '%s' (see --help)\n", argv[k]);
      return 2;
    } else {
      files.push_back(argv[k]);
    }
  }
  if (files.size() < 2) {
    std::fprintf(stderr, "fcl_artic_verify: a world and certificates are needed (see --help)\n");
    return 2;
  }
  std::size_t verified = 0, all = 0;
  bool bad = false;
  try {
    const std::string world_text = readFile(files[0]);
    const verify::World world = verify::readWorld(world_text);
    for (std::size_t f = 1; f < files.size(); ++f) {
      const std::string bytes = readFile(files[f]);
      std::size_t number = 0;
      for (const verify::Record& record : verify::splitRecords(bytes)) {
        const verify::Verdict verdict = verify::verifyRecord(world, record, options);
        ++all;
        verified += verdict.verified;
        bad = bad || verdict.bad_input;
        if (json) printJson(world, record);
        if (!verdict.verified || !quiet) std::printf("%s:%zu: ", files[f], number);
        if (!verdict.verified) std::printf("NOT VERIFIED: %s\n", verdict.reason.c_str());
        if (verdict.verified && !quiet) print(verdict);
        ++number;
      }
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fcl_artic_verify: %s\n", error.what());
    return 2;
  }
  std::printf("%zu of %zu records verified\n", verified, all);
  return bad ? 2 : verified == all ? 0 : 1;
}
