// SPDX-License-Identifier: BSD-3-Clause
// Many random tubes: those that are verified against samples, and as many forged ones.
//   tube_campaign COUNT SEED SAMPLES [FOLDER]
// writes what is verified to FOLDER (which is there) as NUMBER.world and NUMBER.fac. Then no body moves by itself:
// fcl_artic_prove, which reads the files, does not know that.
#include <cstdlib>
#include <fstream>

#include "tubes.h"

int main(int argc, char** argv) {
  if (argc != 4 && argc != 5) return 2;
  const int count = std::atoi(argv[1]), samples = std::atoi(argv[3]);
  int number = 0;
  bool written = true;
  const auto write = [&](const std::string& end, const std::string& bytes) {
    std::ofstream file(std::string(argv[4]) + "/" + std::to_string(number) + end, std::ios::binary);
    file << bytes;
    written = written && file.flush();
  };
  const auto keep = [&](const std::string& world, const std::string& record) {
    if (argc < 5) return;
    ++number;
    write(".world", world);
    write(".fac", record);
  };
  const auto c =
      verify::test::tubeCampaign(std::strtoull(argv[2], nullptr, 10), count, count, samples, argc == 4, keep);
  std::printf(
      "%d verified, %d of them with speeds, %d falsified by samples, %d not proven; %d forged, %d of them accepted\n",
      c.verified, c.with_speeds, c.falsified, c.refused, c.forged, c.accepted);
  if (!written) std::printf("not all files could be written\n");
  return c.falsified == 0 && c.accepted == 0 && written ? 0 : 1;
}
