// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "fcl_artic/result.h"

namespace fcl_artic {

/// The answer for two moving objects. Always written in full.
struct CertifiedPairResult {
  Status status = Status::undecided;
  /// The motion is proven free on [0, t_lower).
  double t_lower = 0;
  /// With `certain`, the first contact is proven to lie at or before t_upper. Otherwise 1, or the time of a later
  /// proven contact.
  double t_upper = 1;
  /// Contact is proven, not only undecidable within the tolerances; t_upper - t_lower is no more than tolerance_time
  /// then, but with ContactMode::any.
  bool certain = false;
  std::vector<CertifiedContact> contacts;
  /// Poses of both objects at t_lower, where they do not touch yet, and at t_upper, where, when certain, they do.
  Eigen::Isometry3d tf1_at_lower = Eigen::Isometry3d::Identity(), tf2_at_lower = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d tf1_at_upper = Eigen::Isometry3d::Identity(), tf2_at_upper = Eigen::Isometry3d::Identity();
  /// The objects touch at t = 0, and that was ignored (CertifiedRequest::ignore_initial_contact).
  bool ignored_initial_contact = false;
  QueryStatistics statistics;

  bool isFree() const { return status == Status::free; }
};

}  // namespace fcl_artic
