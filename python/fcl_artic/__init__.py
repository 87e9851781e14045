# SPDX-License-Identifier: BSD-3-Clause
"""Certified continuous collision detection for articulated robots.

Given a robot, a scene and a motion of all joints, it says what touches first, where and when, or proves that nothing
does::

    import fcl_artic

    robot = fcl_artic.load_urdf("robot.urdf", "robot.srdf")
    world = fcl_artic.World(robot, fcl_artic.load_scene("cell.stl"))
    result = world.check(q0, q1)  # joint values, rad or m, in the order of robot.tree.variables
    if result.free:
        ...

Lengths are in metres, angles in radians, poses are 4x4 matrices (or a position of three numbers), time runs from 0 to
1 or is a trajectory's own. A motion that cannot be proven free is never called free.
"""
from ._enums import (
    ContactMode,
    FeatureKind,
    GuardReason,
    JointType,
    LinkPairKind,
    Method,
    MotionEnclosure,
    Status,
    VisibilityExecutor,
    VisibilityMode,
)
from ._fcl_artic import (
    Answers,
    Bodies,
    BodiesResult,
    Body,
    BodyPair,
    Certificate,
    Clearance,
    Contact,
    Geometry,
    Guard,
    Joint,
    JointMotion,
    JointTrajectory,
    KinematicTree,
    LinkGeometry,
    LinkPairFinding,
    LinkPairProofs,
    LinkPairReport,
    LiveScene,
    Mimic,
    Motion,
    Obstacle,
    PairResult,
    Plan,
    RedonOptions,
    Request,
    Result,
    Robot,
    Scene,
    ToleranceLeft,
    ToolDeviation,
    World,
    __version__,
    box,
    capsule,
    combine_robots,
    combine_scenes,
    cone,
    continuous_collide,
    convex,
    cylinder,
    ellipsoid,
    halfspace,
    in_between_motion,
    in_between_tree,
    instruction_set,
    load_mesh,
    load_plans,
    load_points,
    load_scene,
    load_srdf,
    load_urdf,
    mesh,
    octree,
    points,
    plane,
    read_srdf,
    replay,
    sphere,
    tool_deviation,
    triangle,
    unit_notes,
)
from ._guard import AheadAnswer, GuardAnswer, Separation
from ._picture import Picture
from ._poses import pose
from ._report import Report


def _pickle_by_protocol_2() -> None:
    """Protocols 0 and 1 know nothing of state that a class sets itself: they would leave objects without insides."""
    from . import _fcl_artic

    def reduce(self, protocol):
        return object.__reduce_ex__(self, max(protocol, 2))

    for kind in vars(_fcl_artic).values():
        if isinstance(kind, type) and "__setstate__" in vars(kind):
            setattr(kind, "__reduce_ex__", reduce)


_pickle_by_protocol_2()
del _pickle_by_protocol_2

__all__ = [
    "AheadAnswer",
    "Answers",
    "Bodies",
    "BodiesResult",
    "Body",
    "BodyPair",
    "Certificate",
    "Clearance",
    "Contact",
    "ContactMode",
    "FeatureKind",
    "Geometry",
    "Guard",
    "GuardAnswer",
    "GuardReason",
    "Joint",
    "JointMotion",
    "JointTrajectory",
    "JointType",
    "KinematicTree",
    "LinkGeometry",
    "LinkPairFinding",
    "LinkPairKind",
    "LinkPairProofs",
    "LinkPairReport",
    "LiveScene",
    "Method",
    "Mimic",
    "Motion",
    "MotionEnclosure",
    "Obstacle",
    "PairResult",
    "Picture",
    "Plan",
    "RedonOptions",
    "Report",
    "Request",
    "Result",
    "Robot",
    "Scene",
    "Separation",
    "Status",
    "ToleranceLeft",
    "ToolDeviation",
    "VisibilityExecutor",
    "VisibilityMode",
    "World",
    "__version__",
    "box",
    "capsule",
    "combine_robots",
    "combine_scenes",
    "cone",
    "continuous_collide",
    "convex",
    "cylinder",
    "ellipsoid",
    "halfspace",
    "in_between_motion",
    "in_between_tree",
    "instruction_set",
    "load_mesh",
    "load_plans",
    "load_points",
    "load_scene",
    "load_srdf",
    "load_urdf",
    "mesh",
    "octree",
    "points",
    "plane",
    "pose",
    "read_srdf",
    "replay",
    "sphere",
    "tool_deviation",
    "triangle",
    "unit_notes",
]
