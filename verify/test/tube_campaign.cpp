// SPDX-License-Identifier: BSD-3-Clause
// Many random tubes: those that are verified against samples, and as many forged ones.
//   tube_campaign COUNT SEED SAMPLES
#include <cstdlib>

#include "tubes.h"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const int count = std::atoi(argv[1]), samples = std::atoi(argv[3]);
  const auto c = verify::test::tubeCampaign(std::strtoull(argv[2], nullptr, 10), count, count, samples);
  std::printf("%d verified, %d of them falsified by samples, %d not proven; %d forged, %d of them accepted\n",
              c.verified, c.falsified, c.refused, c.forged, c.accepted);
  return c.falsified == 0 && c.accepted == 0 ? 0 : 1;
}
