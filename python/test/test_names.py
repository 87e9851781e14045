# SPDX-License-Identifier: BSD-3-Clause
"""Every public name of the C++ library is reachable in Python, or listed here with the reason why it is not."""
import ast
import enum
import pathlib
import re
import subprocess
import sys

import pytest

import fcl_artic

INCLUDE = pathlib.Path(__file__).resolve().parents[2] / "include" / "fcl_artic"

# C++ name: where it is in Python (attribute of fcl_artic).
REACHABLE = {
    # kinematic_tree.h, joint_motion.h, trajectory.h, in_between.h
    "JointType": "JointType",
    "Mimic": "Mimic",
    "Joint": "Joint",
    "KinematicTree": "KinematicTree",
    "hasLimits": "Joint.has_limits",
    "JointMotion": "JointMotion",
    "JointTrajectory": "JointTrajectory",
    "Unwrap": "JointTrajectory.linear",  # unwrap=True
    "inBetweenTree": "in_between_tree",
    "inBetweenMotion": "in_between_motion",
    # request.h, result.h, bracket.h, statistics.h, clearance.h, tolerance_left.h, certificate.h, pair_result.h
    "ContactMode": "ContactMode",
    "VisibilityMode": "VisibilityMode",
    "Method": "Method",
    "MotionEnclosure": "MotionEnclosure",
    "RedonOptions": "RedonOptions",
    "Tolerances": "Request.tolerance_time",
    "Effort": "Request.work_budget",
    "Scope": "Request.check_self",
    "JointTolerance": "World.set_joint_tolerance",
    "PoseTolerance": "World.set_object_tolerance",
    "ObjectSpeed": "World.set_object_speed",
    "LiveScene": "LiveScene",
    "Snapshot": "LiveScene.seen_at",
    "Guard": "Guard",
    "GuardOptions": "Guard",  # its options
    "GuardReason": "GuardReason",
    "GuardAnswer": "GuardAnswer",
    "AheadAnswer": "AheadAnswer",
    "Separation": "Separation",
    "CertifiedPairRequest": "Request",
    "CertifiedRequest": "Request",
    "Status": "Status",
    "Bracket": "Result.t_lower",
    "FeatureKind": "FeatureKind",
    "BodyRef": "Body",
    "CertifiedContact": "Contact",
    "ToleranceWitness": "Contact.q_witness",  # and its deviations
    "CertifiedResult": "Result",
    "CertifiedPairResult": "PairResult",
    "StandardStatistics": "Result.statistics",
    "RedonStatistics": "Result.statistics",
    "VisibilityStatistics": "Result.statistics",
    "QueryStatistics": "Result.statistics",
    # interpolation.h: a plan's options, as text
    "Interpolation": "load_plans",
    "interpolationNamed": "load_plans",
    "Turns": "load_plans",
    "turnsNamed": "load_plans",
    "turnsOf": "load_plans",
    "curveOf": "load_plans",
    "Waypoints": "Plan",
    "makeTrajectory": "Plan.trajectory",
    "ClearanceRequest": "World.clearance",  # its options
    "ToolLineRequest": "tool_deviation",  # its options
    "ToolDeviation": "ToolDeviation",
    "toolDeviation": "tool_deviation",
    "Clearance": "Clearance",
    "ToleranceLeftRequest": "World.tolerance_left",  # its options
    "ToleranceLeft": "ToleranceLeft",
    "Certificate": "Certificate",
    # manager.h, link_pairs.h
    "ArticulatedCollisionManager": "World",
    "AllowedCollisionMatrix": "World.allowed",  # a frozenset of pairs
    "LinkPairKind": "LinkPairKind",
    "LinkPairFinding": "LinkPairFinding",
    "LinkPairOptions": "Robot.classify_link_pairs",  # its options
    "LinkPairProofs": "LinkPairProofs",
    "LinkPairReport": "LinkPairReport",
    # continuous_collision.h, continuous_manager.h, bounded_motion.h, fcl_link_motion.h, solid_mesh.h
    "continuousCollide": "continuous_collide",
    "collide": "continuous_collide",
    "ContinuousCollisionManager": "Bodies",
    "CertifiedPairsResult": "BodiesResult",
    "MovingPair": "BodyPair",
    "sweptAABB": "Bodies.swept_box",
    "BoundedMotion": "Motion.bounded",
    "FclLinkMotion": "Motion.of_link",
    "SolidMesh": "mesh",  # solid=True
    "PointCloud": "points",
    "loadPointCloud": "load_points",
    "FrameLayout": "points",  # an array's own
    "FramePoints": "Geometry.missing",
    "readFrame": "points",
    "SolidMark": "Geometry.solid",
    "makeSolid": "Geometry.as_solid",
    # visibility.h, visibility/offscreen.h
    "VisibilityOptions": "World.set_visibility",
    "VisibilityCuller": "World.set_visibility",
    "OffscreenBackend": "VisibilityExecutor",
    "makeOffscreenCuller": "World.set_visibility",
    # urdf/urdf.h
    "LinkGeometry": "LinkGeometry",
    "Robot": "Robot",
    "UrdfOptions": "load_urdf",  # its options
    "loadUrdf": "load_urdf",
    "VirtualJoint": "load_urdf",  # its option virtual_joint
    "loadVirtualJoint": "load_urdf",
    "PlacedRobot": "combine_robots",
    "combineRobots": "combine_robots",
    "reachUpper": "Robot.reach",
    "SrdfPair": "read_srdf",
    "loadSrdf": "load_srdf",
    "readSrdf": "read_srdf",
    "generateAllowedCollisions": "Robot.classify_link_pairs",
    "writeSrdf": "LinkPairReport.write_srdf",
    "Scene": "Scene",
    "Obstacle": "Obstacle",
    "SceneOptions": "load_scene",  # its options
    "loadScene": "load_scene",
    "combineScenes": "combine_scenes",
    "unitNotes": "unit_notes",
    "loadMesh": "load_mesh",
    # query_text.h
    "readQuery": "replay",
    "RecordedQuery": "replay",  # answers at once
    # instruction_set.h
    "instructionSet": "instruction_set",
}

# C++ name: why Python has no need of it.
LEFT_OUT = {
    "LinkId": "an int; links go by their names",
    "JointId": "an int; joints go by their names",
    "ObjectRef": "an argument of C++; objects are values and names in Python",
    "LinkRef": "an argument of C++; links go by their names",
    "Fingerprint": "JointMotion.is_of() compares the joint spaces of trees",
    "toString": "the members of the enumerations have values as text",
    "isController": "an interpolation is text in Python",
    "WaypointValues": "Plan.velocities and .accelerations are None where a plan has none",
    "restToRestVelocities": "load_plans(interpolation='jtc-upsampled') goes by them",
    "exceptionsOf": "a result's text ends with it: str(result)",
    "DefaultContinuousCollisionFunction": "a callback for FCL's own managers in C++; Bodies.check() answers",
    "OffscreenContext": "a context of OpenGL for C++ programs that draw",
    "State": "a tuple that Motion.bounded()'s function returns",
    "Bounds": "numbers that Motion.bounded()'s function returns",
    "Executor": "internal",
    "Drawing": "internal",
    "ExecutorFactory": "internal",
    "Object": "an alias of FCL's type",
    "Callback": "an alias of FCL's type",
    "BodyMotion": "internal, declared only",
    # OMPL: Debian 12 has no Python bindings of it, so that nothing could be tried
    "planning": "no Python bindings of OMPL are in Debian 12; World.is_free() is what a validity checker calls",
    "pinocchio": "for programs in C++; load_urdf() reads the file that pinocchio's model was read from",
    "tesseract": "a contact manager that Tesseract's own programs call",
}

# C++ class: where its members are, and members that are elsewhere or left out, with the reason.
MEMBERS = {
    "ArticulatedCollisionManager": (
        "World",
        {
            "sharedTree": "tree",
            "registerObject": "add",
            "replaceObject": "move",
            "copy": "LiveScene() and its renew() take one",
            "hasSpeeds": "tolerances",
            "registerObjects": "add_scene",
            "replaceObstacles": "replace_scene",
            "shareRobot": "one world is asked by many threads; replace_scene() keeps what was made of the robot",
            "unregisterObject": "remove",
            "bind": "Robot.add_geometry()",
            "unbind": "a world's robot is what it was made of",
            "setAllowedCollisions": "allowed",
            "allowedCollisions": "allowed",
            "setLinkPairProofs": "set_proofs",
            "setJointTolerances": "set_joint_tolerance",
            "describeTolerances": "tolerances",
            "update": "move(); geometries do not change",
            "clear": "make another World",
            "getObjects": "obstacles",
            "boundObjects": "attached",
            "boundOffset": "pose",
            "size": "obstacles",
            "empty": "obstacles",
            "continuousCollide": "check",
            "writeQuery": "dump",
            "pointsOnSelf": "remove_self",
        },
    ),
    "KinematicTree": (
        "KinematicTree",
        {
            "numLinks": "links",
            "numJoints": "joints",
            "linkName": "links",
            "variableJoint": "variables",
            "variableName": "variables",
            "jointVariable": "variables",
            "numVariables": "variables",
            "quaternionVariable": "variables",
            "quaternionJoints": "variables",
            "addJoints": "add_joint",
            "findJoint": "joints",
            "findVariable": "variables",
            "mimicJoints": "joints",
            "parentJoint": "joints",
            "parentLink": "parent",
            "topologicalOrder": "parent",
            "linkId": "links",
            "jointId": "joints",
            "hasLink": "links",
            "jointSpace": "JointMotion.is_of",
            "content": "an aid for C++ caches",
            "neutralConfiguration": "neutral",
            "requireConfiguration": "every function that takes one checks it",
        },
    ),
    "JointMotion": (
        "JointMotion",
        {
            "size": "__len__",
            "requireOf": "is_of",
            "variables": "coefficients",
            "orientations": "coefficients",
            "halfAngles": "references",
            "requirePolynomial": "is_polynomial",
        },
    ),
    "JointTrajectory": ("JointTrajectory", {"numPieces": "__len__", "size": "piece", "requireOf": "World.check refuses"}),
}


def snake(name):
    return re.sub(r"(?<=[a-z0-9])([A-Z])", r"_\1", name).lower()


def resolve(path):
    value = fcl_artic
    for part in path.split("."):
        value = getattr(value, part)
    return value


def headers():
    for path in sorted(INCLUDE.rglob("*.h")):
        if path.name in ("fcl_names.h", "abi.h", "export.h", "fcl_artic.h"):  # FCL's own names; no names
            continue
        text = re.sub(r"//.*", "", path.read_text())
        yield path, text


def public_names():
    names = {}
    for path, text in headers():
        component = {"ompl": "planning", "pinocchio": "pinocchio", "tesseract": "tesseract"}.get(path.parent.name)
        if component:
            names[component] = path
            continue
        for match in re.finditer(r"^\s*(?:class|struct|enum class)\s+(?:FCL_ARTIC_EXPORT\s+)?(\w+)\s*(?:final\s*)?[:{;]", text, re.M):
            if match[1] not in ("Impl", "QueryContext", "MotionQueries", "Turn", "Start", "Step", "Index"):
                names[match[1]] = path
        for match in re.finditer(r"^using (\w+) =", text, re.M):
            names[match[1]] = path
        for match in re.finditer(r"^(?:FCL_ARTIC_EXPORT )[\w:<>,&* ]+?\b(\w+)\(", text, re.M):
            if match[1] != "operator":
                names[match[1]] = path
    return names


def test_every_public_name_is_reachable_or_listed_with_the_reason():
    names = public_names()
    assert len(names) > 70  # or the headers were not found
    missing = {name: path.name for name, path in names.items() if name not in REACHABLE and name not in LEFT_OUT}
    assert not missing
    stale = {name for name in {**REACHABLE, **LEFT_OUT} if name not in names} - {"State", "Bounds", "Unwrap", "Obstacle"}
    inner = {"DefaultContinuousCollisionFunction", "collide", "Executor", "Drawing", "ExecutorFactory", "Object", "Callback"}
    assert not stale - inner


@pytest.mark.parametrize("path", sorted(set(REACHABLE.values())))
def test_what_is_listed_as_reachable_is_there(path):
    resolve(path)


@pytest.mark.parametrize("name", MEMBERS)
def test_every_public_member_is_reachable_or_listed_with_the_reason(name):
    python_name, elsewhere = MEMBERS[name]
    (text,) = [t for _, t in headers() if re.search(rf"^class FCL_ARTIC_EXPORT {name} ", t, re.M)]
    body = text[re.search(rf"^class FCL_ARTIC_EXPORT {name} ", text, re.M).start() :]
    body = body[body.index("public:") : body.index("private:")]
    members = set(re.findall(r"^  (?!\s)[\w\[\]:<>,&* ]*?\b(\w+)\(", body, re.M)) - {name, "operator", "assert"}
    assert len(members) > 5
    python_class = getattr(fcl_artic, python_name)
    missing = {m for m in members if not hasattr(python_class, snake(m)) and m not in elsewhere}
    assert not missing
    for place in elsewhere.values():
        if re.fullmatch(r"\w+", place):
            assert hasattr(python_class, place), place


def test_a_field_of_a_request_stands_everywhere():
    """Fields of C++, the table that the program and JSON go by, Python's keywords, the stub and the manual page."""
    root = INCLUDE.parents[1]
    text = re.sub(r"//.*", "", (INCLUDE / "request.h").read_text())
    fields = {"progress"}  # a std::function
    for name in ("Tolerances", "Effort", "Scope", "CertifiedPairRequest", "CertifiedRequest"):
        body = re.search(rf"^struct {name}\b[^{{;]*{{(.*?)^}};", text, re.M | re.S)[1]
        for line in re.findall(r"^  [\w:]+ (\w+(?: = [^,;]+)?(?:, \w+(?: = [^,;]+)?)*);", body, re.M):
            fields |= {part.split(" = ")[0] for part in line.split(", ")}
    assert len(fields) > 12
    table = re.findall(r'RequestOption\{\s*"(\w+)"', (root / "src" / "query" / "request_options.h").read_text())
    assert set(table) | {"progress"} == fields
    assert {name for name, value in vars(fcl_artic.Request).items() if isinstance(value, property)} == fields
    stub = ast.parse(pathlib.Path(fcl_artic.__file__).with_name("_fcl_artic.pyi").read_text())
    (request,) = (node for node in stub.body if isinstance(node, ast.ClassDef) and node.name == "Request")
    (init,) = (node for node in request.body if isinstance(node, ast.FunctionDef) and node.name == "__init__")
    assert {argument.arg for argument in init.args.kwonlyargs} == fields
    page = (root / "doc" / "man" / "fcl_artic.1").read_text()
    asked = page[page.index("\n.B request\nWhat was asked:") :]
    asked = asked[: asked.index("\n.TP")]
    of_json = fields - {"progress", "redon", "visibility"}  # a call; the two that other objects of JSON tell
    assert set(re.findall(r"^\.BR? (\w+)(?: [,.])?$", asked, re.M)) - {"request"} == of_json


def test_names_are_all_told_and_documented():
    assert sorted(fcl_artic.__all__) == fcl_artic.__all__ or set(fcl_artic.__all__) <= set(dir(fcl_artic))
    for name in fcl_artic.__all__:
        if name != "__version__":
            assert getattr(fcl_artic, name).__doc__, name


def test_every_member_has_a_docstring():
    bare = []
    for name in fcl_artic.__all__:
        owner = getattr(fcl_artic, name)
        if isinstance(owner, type) and not issubclass(owner, enum.Enum):
            members = {k: v for k, v in vars(owner).items() if not k.startswith("_")}
            bare += [f"{name}.{k}" for k, v in members.items() if not (getattr(v, "__doc__", None) or "").strip()]
    assert not bare


def test_import_takes_less_than_a_tenth_of_a_second():
    # Time of the processor: other programs on the machine do not count. NumPy's own import is left out.
    code = "import time, numpy; a = time.process_time(); import fcl_artic; print(time.process_time() - a)"
    times = [float(subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout) for _ in range(5)]
    print(f"import fcl_artic: {1e3 * min(times):.1f} ms after NumPy")
    assert min(times) < 0.1
