// SPDX-License-Identifier: BSD-3-Clause
//
// All of the core library. Components have headers of their own: <fcl_artic/urdf/urdf.h>,
// <fcl_artic/visibility/offscreen.h>, <fcl_artic/ompl/planning_setup.h> and <fcl_artic/ompl/motion_validator.h>,
// <fcl_artic/pinocchio/pinocchio.h>, <fcl_artic/tesseract/contact_manager.h> and <fcl_artic/tesseract/scene.h>.
#pragma once

#include "fcl_artic/bounded_motion.h"
#include "fcl_artic/certificate.h"
#include "fcl_artic/clearance.h"
#include "fcl_artic/continuous_collision.h"
#include "fcl_artic/continuous_manager.h"
#include "fcl_artic/fcl_link_motion.h"
#include "fcl_artic/guard.h"
#include "fcl_artic/in_between.h"
#include "fcl_artic/instruction_set.h"
#include "fcl_artic/interpolation.h"
#include "fcl_artic/joint_motion.h"
#include "fcl_artic/kinematic_tree.h"
#include "fcl_artic/manager.h"
#include "fcl_artic/pair_result.h"
#include "fcl_artic/point_cloud.h"
#include "fcl_artic/query_text.h"
#include "fcl_artic/redon2004.h"
#include "fcl_artic/references.h"
#include "fcl_artic/request.h"
#include "fcl_artic/result.h"
#include "fcl_artic/solid_mesh.h"
#include "fcl_artic/tolerance_left.h"
#include "fcl_artic/tool_line.h"
#include "fcl_artic/trajectory.h"
#include "fcl_artic/visibility.h"
