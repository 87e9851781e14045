// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fcl_artic {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadiansPerDegree = kPi / 180;

}  // namespace fcl_artic
