# SPDX-License-Identifier: BSD-3-Clause
# Types of the extension module. The docstring of a class or function says what it is for.
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, Protocol, TypeAlias, overload

import numpy as np
import numpy.typing as npt

from ._enums import (
    ContactMode,
    FeatureKind,
    JointType,
    LinkPairKind,
    Method,
    MotionEnclosure,
    Status,
    VisibilityExecutor,
    VisibilityMode,
)
from ._guard import AheadAnswer, GuardAnswer
from ._picture import Picture
from ._report import Report

__version__: str

def instruction_set() -> str: ...

_Doubles: TypeAlias = npt.NDArray[np.float64]
_Pose: TypeAlias = npt.ArrayLike  # (4, 4), or a position (3,)
_Pair: TypeAlias = tuple[str, str]
_Path: TypeAlias = str | os.PathLike[str]
_Progress: TypeAlias = Callable[[float], bool | None]

class _HasFaces(Protocol):
    @property
    def vertices(self) -> npt.ArrayLike: ...
    @property
    def faces(self) -> npt.ArrayLike: ...

_HasTree: TypeAlias = KinematicTree | Robot | World
_Shape: TypeAlias = Geometry | _HasFaces

class RedonOptions:
    def __init__(
        self,
        *,
        enclosure: MotionEnclosure | str = ...,
        refinement_level: int = ...,
        simultaneous: bool = ...,
        newton: bool = ...,
        early_validity: bool = ...,
        in_time_order: bool = ...,
        links_in_world: bool = ...,
    ) -> None: ...
    @staticmethod
    def as_written() -> RedonOptions: ...
    enclosure: MotionEnclosure
    refinement_level: int
    simultaneous: bool
    newton: bool
    early_validity: bool
    in_time_order: bool
    links_in_world: bool

class Request:
    def __init__(
        self,
        *,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        certificate: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> None: ...
    mode: ContactMode
    max_contacts: int
    tolerance_time: float
    tolerance_distance: float
    margin: float
    added_margin: float
    check_scene: bool
    check_self: bool
    ignore_initial_contact: bool
    certificate: bool
    visibility: VisibilityMode
    method: Method
    redon: RedonOptions
    work_budget: int
    measure_times: bool
    progress: _Progress | None

class Mimic:
    def __init__(self, master: str, multiplier: float = ..., offset: float = ...) -> None: ...
    master: str
    multiplier: float
    offset: float

class Joint:
    @staticmethod
    def revolute(
        name: str,
        parent: str,
        child: str,
        axis: npt.ArrayLike,
        origin: _Pose | None = ...,
        lower: float = ...,
        upper: float = ...,
        mimic: Mimic | None = ...,
    ) -> Joint: ...
    @staticmethod
    def prismatic(
        name: str,
        parent: str,
        child: str,
        axis: npt.ArrayLike,
        origin: _Pose | None = ...,
        lower: float = ...,
        upper: float = ...,
        mimic: Mimic | None = ...,
    ) -> Joint: ...
    @staticmethod
    def continuous(
        name: str,
        parent: str,
        child: str,
        axis: npt.ArrayLike,
        origin: _Pose | None = ...,
        mimic: Mimic | None = ...,
    ) -> Joint: ...
    @staticmethod
    def planar(name: str, parent: str, child: str, normal: npt.ArrayLike, origin: _Pose | None = ...) -> Joint: ...
    @staticmethod
    def fixed(name: str, parent: str, child: str, origin: _Pose | None = ...) -> Joint: ...
    @staticmethod
    def spherical(name: str, parent: str, child: str, origin: _Pose | None = ...) -> Joint: ...
    @staticmethod
    def floating(name: str, parent: str, child: str, origin: _Pose | None = ...) -> Joint: ...
    @property
    def name(self) -> str: ...
    @property
    def type(self) -> JointType: ...
    @property
    def parent(self) -> str: ...
    @property
    def child(self) -> str: ...
    @property
    def origin(self) -> _Doubles: ...
    @property
    def axis(self) -> _Doubles: ...
    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...
    @property
    def has_limits(self) -> bool: ...
    @property
    def mimic(self) -> Mimic | None: ...

class KinematicTree:
    def __init__(self, name: str = ...) -> None: ...
    def add_link(self, name: str) -> int: ...
    def add_joint(self, joint: Joint) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def dof(self) -> int: ...
    @property
    def links(self) -> list[str]: ...
    @property
    def joints(self) -> list[Joint]: ...
    @property
    def variables(self) -> list[str]: ...
    @property
    def limits(self) -> _Doubles: ...
    @property
    def neutral(self) -> _Doubles: ...
    def joint(self, name: str) -> Joint: ...
    def parent(self, link: str | int) -> str | None: ...
    def is_angle(self, variable: int) -> bool: ...
    def joint_value(self, joint: str, q: npt.ArrayLike) -> float: ...
    def joint_pose(self, joint: str, q: npt.ArrayLike) -> _Doubles: ...
    def forward_kinematics(self, q: npt.ArrayLike) -> _Doubles: ...
    def link_pose(self, link: str | int, q: npt.ArrayLike) -> _Doubles: ...
    def limit_notes(self, q: npt.ArrayLike) -> list[str]: ...
    def __deepcopy__(self, memo: Any) -> KinematicTree: ...

class JointMotion:
    @staticmethod
    def linear(tree: _HasTree, q0: npt.ArrayLike, q1: npt.ArrayLike) -> JointMotion: ...
    @staticmethod
    def shortest(tree: _HasTree, q0: npt.ArrayLike, q1: npt.ArrayLike) -> JointMotion: ...
    @staticmethod
    def still(tree: _HasTree, q: npt.ArrayLike) -> JointMotion: ...
    @staticmethod
    def polynomial(tree: _HasTree, coefficients: npt.ArrayLike) -> JointMotion: ...
    @staticmethod
    def tangent_half_angle(
        tree: _HasTree, q0: npt.ArrayLike, q1: npt.ArrayLike, reference: npt.ArrayLike | None = ...
    ) -> JointMotion: ...
    @staticmethod
    def tangent_half_angle_polynomial(
        tree: _HasTree, coefficients: npt.ArrayLike, reference: npt.ArrayLike | None = ...
    ) -> JointMotion: ...
    @property
    def is_polynomial(self) -> bool: ...
    @property
    def references(self) -> _Doubles | None: ...
    @property
    def q0(self) -> _Doubles: ...
    @property
    def dq(self) -> _Doubles: ...
    @property
    def degree(self) -> int: ...
    @property
    def coefficients(self) -> _Doubles: ...
    def configuration(self, t: float) -> _Doubles: ...
    def is_of(self, tree: _HasTree) -> bool: ...
    def __len__(self) -> int: ...

class JointTrajectory:
    @staticmethod
    def tangent_half_angle(
        tree: _HasTree,
        times: npt.ArrayLike,
        waypoints: npt.ArrayLike,
        reference: npt.ArrayLike | None = ...,
    ) -> JointTrajectory: ...
    @staticmethod
    def linear(
        tree: _HasTree,
        times: npt.ArrayLike,
        waypoints: npt.ArrayLike,
        unwrap: bool = ...,
    ) -> JointTrajectory: ...
    @staticmethod
    def cubic(
        tree: _HasTree,
        times: npt.ArrayLike,
        waypoints: npt.ArrayLike,
        velocities: npt.ArrayLike,
        unwrap: bool = ...,
    ) -> JointTrajectory: ...
    @staticmethod
    def quintic(
        tree: _HasTree,
        times: npt.ArrayLike,
        waypoints: npt.ArrayLike,
        velocities: npt.ArrayLike,
        accelerations: npt.ArrayLike,
        unwrap: bool = ...,
    ) -> JointTrajectory: ...
    @staticmethod
    def parabolic_blends(
        tree: _HasTree,
        times: npt.ArrayLike,
        waypoints: npt.ArrayLike,
        blend: float,
        unwrap: bool = ...,
    ) -> JointTrajectory: ...
    @staticmethod
    def bspline(
        tree: _HasTree,
        degree: int,
        knots: npt.ArrayLike,
        control_points: npt.ArrayLike,
    ) -> JointTrajectory: ...
    @staticmethod
    def piecewise(tree: _HasTree, times: npt.ArrayLike, coefficients: Sequence[npt.ArrayLike]) -> JointTrajectory: ...
    @property
    def begin_time(self) -> float: ...
    @property
    def end_time(self) -> float: ...
    @property
    def times(self) -> _Doubles: ...
    def configuration(self, t: float) -> _Doubles: ...
    def piece(self, k: int) -> JointMotion: ...
    def __len__(self) -> int: ...

class Plan:
    @property
    def name(self) -> str: ...
    @property
    def error(self) -> str | None: ...
    @property
    def trajectory(self) -> JointTrajectory: ...
    @property
    def interpolation(self) -> str | None: ...
    @property
    def times(self) -> _Doubles | None: ...
    @property
    def waypoints(self) -> _Doubles | None: ...
    @property
    def joints(self) -> list[str] | None: ...
    @property
    def carried(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...
    def waypoint_before(self, t: float) -> int: ...

class Geometry:
    @property
    def kind(self) -> str: ...
    @property
    def missing(self) -> int: ...
    @property
    def solid(self) -> bool: ...
    @property
    def vertices(self) -> _Doubles: ...
    @property
    def faces(self) -> npt.NDArray[np.int64]: ...
    def as_solid(self) -> Geometry: ...
    def __eq__(self, other: object) -> bool: ...
    def __hash__(self) -> int: ...

class Certificate:
    @property
    def world(self) -> str | None: ...
    @property
    def motion(self) -> str: ...
    @property
    def proof(self) -> bytes: ...
    @property
    def missing(self) -> str: ...
    def record(self) -> bytes: ...
    def save(self, path: _Path) -> None: ...
    def __bool__(self) -> bool: ...

class Body:
    @property
    def name(self) -> str: ...
    @property
    def link(self) -> int | None: ...

class Contact:
    @property
    def body1(self) -> Body: ...
    @property
    def body2(self) -> Body: ...
    @property
    def pair(self) -> _Pair: ...
    @property
    def piece1(self) -> int | None: ...
    @property
    def piece2(self) -> int | None: ...
    @property
    def feature(self) -> FeatureKind: ...
    @property
    def point(self) -> _Doubles: ...
    @property
    def normal(self) -> _Doubles: ...
    @property
    def nearest1(self) -> _Doubles: ...
    @property
    def nearest2(self) -> _Doubles: ...
    @property
    def approach_speed(self) -> float: ...
    @property
    def t_lower(self) -> float: ...
    @property
    def t_upper(self) -> float: ...
    @property
    def certain(self) -> bool: ...
    @property
    def q_witness(self) -> _Doubles | None: ...
    @property
    def base_deviation(self) -> _Doubles | None: ...
    @property
    def deviation1(self) -> _Doubles | None: ...
    @property
    def deviation2(self) -> _Doubles | None: ...

class Result:
    @property
    def status(self) -> Status: ...
    @property
    def free(self) -> bool: ...
    @property
    def contact(self) -> bool: ...
    @property
    def undecided(self) -> bool: ...
    @property
    def t_lower(self) -> float: ...
    @property
    def t_upper(self) -> float: ...
    @property
    def certain(self) -> bool: ...
    @property
    def contacts(self) -> list[Contact]: ...
    @property
    def first(self) -> Contact | None: ...
    @property
    def certificate(self) -> Certificate | None: ...
    @property
    def statistics(self) -> dict[str, Any]: ...
    @property
    def pair(self) -> _Pair | None: ...
    @property
    def link_poses(self) -> _Doubles: ...
    @property
    def ignored_initial_contacts(self) -> list[_Pair]: ...
    @property
    def never_apart_pairs(self) -> int: ...
    @property
    def unproven_allowed_pairs(self) -> int: ...
    @property
    def unproven_neighbours(self) -> list[_Pair]: ...
    @property
    def nothing_checked(self) -> bool: ...
    def __bool__(self) -> bool: ...

class PairResult:
    @property
    def status(self) -> Status: ...
    @property
    def free(self) -> bool: ...
    @property
    def contact(self) -> bool: ...
    @property
    def undecided(self) -> bool: ...
    @property
    def t_lower(self) -> float: ...
    @property
    def t_upper(self) -> float: ...
    @property
    def certain(self) -> bool: ...
    @property
    def contacts(self) -> list[Contact]: ...
    @property
    def first(self) -> Contact | None: ...
    @property
    def certificate(self) -> Certificate | None: ...
    @property
    def statistics(self) -> dict[str, Any]: ...
    @property
    def pose1_at_lower(self) -> _Doubles: ...
    @property
    def pose2_at_lower(self) -> _Doubles: ...
    @property
    def pose1_at_upper(self) -> _Doubles: ...
    @property
    def pose2_at_upper(self) -> _Doubles: ...
    @property
    def ignored_initial_contact(self) -> bool: ...
    @property
    def never_apart(self) -> bool: ...
    def __bool__(self) -> bool: ...

class Clearance:
    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...
    @property
    def time(self) -> float: ...
    @property
    def pair(self) -> _Pair | None: ...
    @property
    def body1(self) -> Body: ...
    @property
    def body2(self) -> Body: ...
    @property
    def within_tolerance(self) -> bool: ...
    @property
    def ignored_initial_contacts(self) -> list[_Pair]: ...
    @property
    def statistics(self) -> dict[str, Any]: ...

class ToleranceLeft:
    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...
    @property
    def time(self) -> float: ...
    @property
    def pair(self) -> _Pair | None: ...
    @property
    def body1(self) -> Body: ...
    @property
    def body2(self) -> Body: ...
    @property
    def certain(self) -> bool: ...
    @property
    def q_witness(self) -> _Doubles | None: ...
    @property
    def base_deviation(self) -> _Doubles | None: ...
    @property
    def deviation1(self) -> _Doubles | None: ...
    @property
    def deviation2(self) -> _Doubles | None: ...
    @property
    def within_accuracy(self) -> bool: ...
    @property
    def ignored_initial_contacts(self) -> list[_Pair]: ...
    @property
    def statistics(self) -> dict[str, Any]: ...

class ToolDeviation:
    @property
    def distance_lower(self) -> float: ...
    @property
    def distance_upper(self) -> float: ...
    @property
    def distance_time(self) -> float: ...
    @property
    def angle_lower(self) -> float: ...
    @property
    def angle_upper(self) -> float: ...
    @property
    def angle_time(self) -> float: ...
    @property
    def length(self) -> float: ...
    @property
    def within_tolerance(self) -> bool: ...
    def certainly_keeps(self, distance: float, angle: float) -> bool: ...
    def certainly_leaves(self, distance: float, angle: float) -> bool: ...

def tool_deviation(
    tree: _HasTree,
    motion: JointMotion | JointTrajectory,
    link: str | int,
    *,
    tool: _Pose | None = ...,
    via: npt.ArrayLike | None = ...,
    tolerance_distance: float = ...,
    tolerance_angle: float = ...,
    work_budget: int = ...,
) -> ToolDeviation: ...

class LinkPairProofs: ...

class LinkPairFinding:
    @property
    def link1(self) -> str: ...
    @property
    def link2(self) -> str: ...
    @property
    def kind(self) -> LinkPairKind: ...
    @property
    def neighbours(self) -> bool: ...
    @property
    def proven(self) -> bool: ...
    @property
    def tried(self) -> int: ...
    @property
    def touching(self) -> int: ...
    @property
    def apart(self) -> int: ...
    @property
    def configuration(self) -> _Doubles: ...
    @property
    def nearest(self) -> float: ...

class LinkPairReport:
    @property
    def pairs(self) -> list[LinkPairFinding]: ...
    @property
    def proofs(self) -> LinkPairProofs: ...
    @property
    def always_touching(self) -> frozenset[_Pair]: ...
    @property
    def need_no_check(self) -> frozenset[_Pair]: ...
    def count(self, kind: LinkPairKind | str) -> int: ...
    def write_srdf(self, path: _Path, robot_name: str) -> None: ...
    def __len__(self) -> int: ...

class LinkGeometry:
    @property
    def link(self) -> int: ...
    @property
    def offset(self) -> _Doubles: ...
    @property
    def geometry(self) -> Geometry: ...
    @property
    def source(self) -> str: ...

class Robot:
    def __init__(self, tree: KinematicTree) -> None: ...
    @property
    def allowed(self) -> frozenset[_Pair]: ...
    @allowed.setter
    def allowed(self, pairs: Iterable[_Pair]) -> None: ...
    @property
    def allowed_complete(self) -> bool: ...
    @allowed_complete.setter
    def allowed_complete(self, complete: bool) -> None: ...
    @property
    def proofs(self) -> LinkPairProofs: ...
    @proofs.setter
    def proofs(self, proofs: LinkPairProofs | None) -> None: ...
    @property
    def tree(self) -> KinematicTree: ...
    @property
    def name(self) -> str: ...
    @property
    def dof(self) -> int: ...
    @property
    def geometry(self) -> list[LinkGeometry]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def reach(self) -> float: ...
    def add_geometry(
        self,
        link: str | int,
        geometry: _Shape,
        offset: _Pose | None = ...,
        source: str = ...,
    ) -> None: ...
    def classify_link_pairs(
        self,
        *,
        only: Iterable[_Pair] | None = ...,
        margin: float = ...,
        work: int = ...,
        samples: int = ...,
        threads: int = ...,
        progress: _Progress | None = ...,
    ) -> LinkPairReport: ...

class Obstacle:
    @property
    def name(self) -> str: ...
    @property
    def shape_of(self) -> str: ...
    @property
    def geometry(self) -> Geometry: ...
    @property
    def pose(self) -> _Doubles: ...

class Scene:
    def __init__(self) -> None: ...
    def add(self, name: str, geometry: _Shape, pose: _Pose | None = ...) -> None: ...
    def remove(self, name: str) -> None: ...
    @property
    def obstacles(self) -> list[Obstacle]: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...
    def __getitem__(self, name: str) -> Obstacle: ...
    def __contains__(self, name: str) -> bool: ...
    def __iter__(self) -> Iterator[Obstacle]: ...
    def __len__(self) -> int: ...

class Motion:
    @staticmethod
    def still(pose: _Pose | None = ...) -> Motion: ...
    @staticmethod
    def translation(begin: _Pose, displacement: npt.ArrayLike) -> Motion: ...
    @staticmethod
    def linear(begin: _Pose, end: _Pose) -> Motion: ...
    @staticmethod
    def screw(begin: _Pose, end: _Pose) -> Motion: ...
    @staticmethod
    def spline(positions: npt.ArrayLike, rotations: npt.ArrayLike) -> Motion: ...
    @staticmethod
    def of_link(tree: _HasTree, motion: JointMotion, link: str | int, offset: _Pose | None = ...) -> Motion: ...
    @staticmethod
    def bounded(
        state: Callable[[float], Any],
        bounds: Callable[[float, float], Sequence[float]],
        derivatives: bool = ...,
    ) -> Motion: ...
    @property
    def kind(self) -> str: ...
    def pose(self, t: float) -> _Doubles: ...

class BodyPair:
    @property
    def name1(self) -> str: ...
    @property
    def name2(self) -> str: ...
    @property
    def result(self) -> PairResult: ...

class BodiesResult:
    @property
    def status(self) -> Status: ...
    @property
    def free(self) -> bool: ...
    @property
    def contact(self) -> bool: ...
    @property
    def undecided(self) -> bool: ...
    @property
    def t_lower(self) -> float: ...
    @property
    def t_upper(self) -> float: ...
    @property
    def certain(self) -> bool: ...
    @property
    def pairs(self) -> list[BodyPair]: ...
    @property
    def ignored_initial_contacts(self) -> list[_Pair]: ...
    @property
    def never_apart_pairs(self) -> int: ...
    @property
    def statistics(self) -> dict[str, Any]: ...
    def __bool__(self) -> bool: ...

class Bodies:
    def __init__(self) -> None: ...
    def add(self, name: str, geometry: _Shape, motion: Motion | npt.NDArray[Any]) -> None: ...
    def remove(self, name: str) -> None: ...
    def set_motion(self, name: str, motion: Motion | npt.NDArray[Any]) -> None: ...
    @property
    def names(self) -> list[str]: ...
    def check(
        self,
        *,
        request: Request | None = ...,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        ignore_initial_contact: bool = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
    ) -> BodiesResult: ...
    def check_against(
        self,
        other: Bodies,
        *,
        request: Request | None = ...,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        ignore_initial_contact: bool = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
    ) -> BodiesResult: ...
    def swept_box(self, name: str) -> tuple[_Doubles, _Doubles]: ...
    def __len__(self) -> int: ...
    def __contains__(self, name: str) -> bool: ...

class Answers:
    @property
    def status(self) -> npt.NDArray[np.int8]: ...
    @property
    def t_lower(self) -> _Doubles: ...
    @property
    def t_upper(self) -> _Doubles: ...
    @property
    def certain(self) -> npt.NDArray[np.bool_]: ...
    @property
    def pair(self) -> npt.NDArray[np.int32]: ...
    @property
    def point(self) -> _Doubles: ...
    @property
    def normal(self) -> _Doubles: ...
    @property
    def ignored_initial_contacts(self) -> npt.NDArray[np.int32]: ...
    @property
    def never_apart_pairs(self) -> npt.NDArray[np.int32]: ...
    @property
    def unproven_allowed_pairs(self) -> npt.NDArray[np.int32]: ...
    @property
    def bodies(self) -> list[str]: ...
    @property
    def free(self) -> npt.NDArray[np.bool_]: ...
    @property
    def contact(self) -> npt.NDArray[np.bool_]: ...
    @property
    def undecided(self) -> npt.NDArray[np.bool_]: ...
    def pair_names(self, i: int) -> _Pair | None: ...
    def __len__(self) -> int: ...
    def __bool__(self) -> bool: ...

class World:
    def __init__(self, robot: Robot, scene: Scene | None = ...) -> None: ...
    @property
    def allowed(self) -> frozenset[_Pair]: ...
    @allowed.setter
    def allowed(self, pairs: Iterable[_Pair]) -> None: ...
    @property
    def robot(self) -> Robot: ...
    @property
    def tree(self) -> KinematicTree: ...
    @property
    def dof(self) -> int: ...
    @property
    def obstacles(self) -> list[str]: ...
    @property
    def moving(self) -> list[str]: ...
    @property
    def attached(self) -> dict[str, str]: ...
    @property
    def neighbours(self) -> list[LinkPairFinding]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def names(self) -> list[str]: ...
    def pose(self, name: str) -> _Doubles: ...
    def add(self, name: str, geometry: _Shape, pose: _Pose | None = ...) -> None: ...
    def add_scene(self, scene: Scene) -> None: ...
    def replace_scene(self, scene: Scene) -> None: ...
    def add_moving(self, name: str, geometry: _Shape, motion: Motion) -> None: ...
    def remove(self, name: str) -> None: ...
    def move(self, name: str, pose: _Pose) -> None: ...
    def attach(
        self, name: str, link: str | int, offset: _Pose | None = ..., touch_links: Sequence[str] = ...
    ) -> None: ...
    def detach(self, name: str, pose: _Pose | None = ...) -> None: ...
    def remove_self(
        self, points: npt.ArrayLike, q: npt.ArrayLike, padding: float = ..., *, pose: _Pose | None = ...
    ) -> tuple[npt.NDArray[Any], int]: ...
    def allow(self, a: str, b: str) -> None: ...
    def disallow(self, a: str, b: str) -> None: ...
    @overload
    def set_margin(self, body: str, other_or_margin: float) -> None: ...
    @overload
    def set_margin(self, body: str, other_or_margin: str, margin: float) -> None: ...
    def reset_margins(self) -> None: ...
    def set_joint_tolerance(self, angle: float = ..., length: float = ..., *, joint: str | None = ...) -> None: ...
    def set_base_tolerance(
        self, length: float = ..., angle: float = ..., *, pivot: npt.ArrayLike = ...
    ) -> None: ...
    def set_object_tolerance(
        self, name: str, length: float = ..., angle: float = ..., *, pivot: npt.ArrayLike = ...
    ) -> None: ...
    def set_object_speed(self, name: str, speed: float, since: float = ...) -> None: ...
    def set_time_tolerance(self, time: float) -> None: ...
    def reset_tolerances(self) -> None: ...
    @property
    def tolerances(self) -> str: ...
    def set_proofs(self, proofs: LinkPairProofs | None) -> None: ...
    def set_visibility(self, executor: VisibilityExecutor | str = ..., *, resolution: int = ...) -> None: ...
    def prepare_for(self, method: Method | str) -> None: ...
    def setup(self) -> None: ...
    @overload
    def check(
        self,
        q0: npt.ArrayLike,
        q1: npt.ArrayLike,
        *,
        request: Request | None = ...,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        certificate: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> Result: ...
    @overload
    def check(
        self,
        q0: JointMotion | JointTrajectory,
        *,
        request: Request | None = ...,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        certificate: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> Result: ...
    def certify(
        self,
        plan: Plan,
        *,
        request: Request | None = ...,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        certificate: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> Result: ...
    def check_trajectory(
        self,
        waypoints: npt.ArrayLike,
        times: npt.ArrayLike | None = ...,
        *,
        velocities: npt.ArrayLike | None = ...,
        accelerations: npt.ArrayLike | None = ...,
        blend: float | None = ...,
        unwrap: bool = ...,
        request: Request | None = ...,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        certificate: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> Result: ...
    @overload
    def dump(
        self,
        path: _Path,
        q0: npt.ArrayLike,
        q1: npt.ArrayLike,
        *,
        request: Request | None = ...,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        certificate: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> None: ...
    @overload
    def dump(
        self,
        path: _Path,
        q0: JointMotion | JointTrajectory,
        *,
        request: Request | None = ...,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        certificate: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> None: ...
    @overload
    def is_free(
        self,
        q0: npt.ArrayLike,
        q1: npt.ArrayLike,
        *,
        request: Request | None = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        certificate: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> bool: ...
    @overload
    def is_free(
        self,
        q0: JointMotion | JointTrajectory,
        *,
        request: Request | None = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        certificate: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> bool: ...
    def collide(
        self,
        q: npt.ArrayLike,
        *,
        request: Request | None = ...,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        certificate: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> Result: ...
    def check_many(
        self,
        q0: npt.ArrayLike,
        q1: npt.ArrayLike,
        threads: int = ...,
        *,
        request: Request | None = ...,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> Answers: ...
    @overload
    def clearance(
        self,
        q0: npt.ArrayLike,
        q1: npt.ArrayLike,
        *,
        tolerance_relative: float = ...,
        tolerance_distance: float = ...,
        most: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        ignored_margin: float = ...,
        work_budget: int = ...,
        progress: _Progress | None = ...,
    ) -> Clearance: ...
    @overload
    def clearance(
        self,
        q0: JointMotion | JointTrajectory,
        *,
        tolerance_relative: float = ...,
        tolerance_distance: float = ...,
        most: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        ignored_margin: float = ...,
        work_budget: int = ...,
        progress: _Progress | None = ...,
    ) -> Clearance: ...
    @overload
    def tolerance_left(
        self,
        q0: npt.ArrayLike,
        q1: npt.ArrayLike,
        *,
        accuracy_relative: float = ...,
        accuracy_factor: float = ...,
        most: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        work_budget: int = ...,
        progress: _Progress | None = ...,
    ) -> ToleranceLeft: ...
    @overload
    def tolerance_left(
        self,
        q0: JointMotion | JointTrajectory,
        *,
        accuracy_relative: float = ...,
        accuracy_factor: float = ...,
        most: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        work_budget: int = ...,
        progress: _Progress | None = ...,
    ) -> ToleranceLeft: ...
    def checked_link_pairs(self) -> list[_Pair]: ...
    def classify_link_pairs(
        self,
        *,
        only: Iterable[_Pair] | None = ...,
        margin: float = ...,
        work: int = ...,
        samples: int = ...,
        threads: int = ...,
        progress: _Progress | None = ...,
    ) -> LinkPairReport: ...
    @overload
    def picture(
        self,
        q0: npt.ArrayLike,
        q1: npt.ArrayLike,
        *,
        result: Result | None = ...,
        size: tuple[int, int] = ...,
        camera: tuple[float, float] | None = ...,
        title: str | None = ...,
    ) -> Picture: ...
    @overload
    def picture(
        self,
        q0: JointMotion | JointTrajectory,
        *,
        result: Result | None = ...,
        size: tuple[int, int] = ...,
        camera: tuple[float, float] | None = ...,
        title: str | None = ...,
    ) -> Picture: ...
    @overload
    def report(
        self,
        q0: npt.ArrayLike,
        q1: npt.ArrayLike,
        result: Result | None = ...,
        path: str | os.PathLike[str] | None = ...,
        *,
        request: Request | None = ...,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        certificate: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> Report: ...
    @overload
    def report(
        self,
        q0: JointMotion | JointTrajectory,
        *,
        result: Result | None = ...,
        path: str | os.PathLike[str] | None = ...,
        request: Request | None = ...,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        certificate: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> Report: ...
    def report_trajectory(
        self,
        waypoints: npt.ArrayLike,
        times: npt.ArrayLike | None = ...,
        *,
        velocities: npt.ArrayLike | None = ...,
        accelerations: npt.ArrayLike | None = ...,
        blend: float | None = ...,
        unwrap: bool = ...,
        result: Result | None = ...,
        path: str | os.PathLike[str] | None = ...,
        request: Request | None = ...,
        mode: ContactMode | str = ...,
        max_contacts: int = ...,
        tolerance_time: float = ...,
        tolerance_distance: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        check_scene: bool = ...,
        check_self: bool = ...,
        ignore_initial_contact: bool = ...,
        certificate: bool = ...,
        visibility: VisibilityMode | str = ...,
        method: Method | str = ...,
        redon: RedonOptions = ...,
        work_budget: int = ...,
        measure_times: bool = ...,
        progress: _Progress | None = ...,
    ) -> Report: ...

def load_urdf(
    urdf: _Path,
    srdf: _Path | None = ...,
    *,
    packages: Mapping[str, _Path] | None = ...,
    base: _Pose | None = ...,
    floating_base: bool = ...,
    virtual_joint: bool = ...,
    solid_meshes: bool = ...,
    collada_up_axis: bool = ...,
    import_meshes: bool = ...,
) -> Robot: ...
def load_scene(
    path: _Path,
    *,
    unknown_cells: bool = ...,
    solid_meshes: bool = ...,
    collada_up_axis: bool = ...,
    scale: float = ...,
    point_radius: float = ...,
    packages: Mapping[str, _Path] | None = ...,
    import_meshes: bool = ...,
) -> Scene: ...
def replay(path: _Path) -> Result: ...
def load_mesh(
    path: _Path,
    *,
    scale: npt.ArrayLike | None = ...,
    solid: bool = ...,
    collada_up_axis: bool = ...,
    import_meshes: bool = ...,
) -> Geometry: ...
def load_plans(
    path: _Path,
    robot: _HasTree,
    *,
    interpolation: str = ...,
    blend: float = ...,
    turns: str = ...,
    ignore_limits: bool = ...,
    joints: Sequence[str] = ...,
    state: Mapping[str, float] = ...,
    format: str | None = ...,
    columns: Sequence[str] = ...,
    skip: Sequence[str] = ...,
    time: str = ...,
    degrees: bool = ...,
    limit_tolerance: float = ...,
) -> list[Plan]: ...
def load_points(path: _Path, radius: float) -> Geometry: ...
def load_srdf(srdf: _Path, tree: _HasTree) -> frozenset[_Pair]: ...
def read_srdf(srdf: _Path, tree: _HasTree) -> list[tuple[str, str, str]]: ...
def combine_robots(parts: Sequence[tuple[Robot, str] | tuple[Robot, str, _Pose]], name: str = ...) -> Robot: ...
def combine_scenes(scenes: Sequence[Scene], tree: _HasTree) -> Scene: ...
def unit_notes(robot: Robot, scene: Scene) -> list[str]: ...
def in_between_tree(tree: _HasTree) -> KinematicTree: ...
def in_between_motion(tree: _HasTree, begin: Iterable[_Pose], end: Iterable[_Pose]) -> JointMotion: ...
def box(size: npt.ArrayLike) -> Geometry: ...
def sphere(radius: float) -> Geometry: ...
def ellipsoid(radii: npt.ArrayLike) -> Geometry: ...
def capsule(radius: float, length: float) -> Geometry: ...
def cylinder(radius: float, length: float) -> Geometry: ...
def cone(radius: float, length: float) -> Geometry: ...
def halfspace(normal: npt.ArrayLike, offset: float = ...) -> Geometry: ...
def plane(normal: npt.ArrayLike, offset: float = ...) -> Geometry: ...
def triangle(a: npt.ArrayLike, b: npt.ArrayLike, c: npt.ArrayLike) -> Geometry: ...
def convex(vertices: npt.ArrayLike, faces: npt.ArrayLike | None = ...) -> Geometry: ...
@overload
def mesh(vertices: npt.ArrayLike, faces: npt.ArrayLike, solid: bool = ...) -> Geometry: ...
@overload
def mesh(vertices: _HasFaces, faces: None = ..., solid: bool = ...) -> Geometry: ...
def octree(points: npt.ArrayLike, resolution: float) -> Geometry: ...
def points(points: npt.ArrayLike, radius: npt.ArrayLike, *, voxel: float | None = ...) -> Geometry: ...
def continuous_collide(
    geometry_a: _Shape,
    motion_a: Motion | npt.NDArray[Any],
    geometry_b: _Shape,
    motion_b: Motion | npt.NDArray[Any],
    *,
    request: Request | None = ...,
    mode: ContactMode | str = ...,
    max_contacts: int = ...,
    tolerance_time: float = ...,
    tolerance_distance: float = ...,
    margin: float = ...,
    added_margin: float = ...,
    ignore_initial_contact: bool = ...,
    certificate: bool = ...,
    method: Method | str = ...,
    redon: RedonOptions = ...,
    work_budget: int = ...,
    measure_times: bool = ...,
    progress: _Progress | None = ...,
) -> PairResult: ...
def _png(image: npt.NDArray[np.uint8]) -> bytes: ...

class LiveScene:
    def __init__(self, world: World, seen_at: float) -> None: ...
    def renew(self, world: World, seen_at: float) -> None: ...
    @property
    def seen_at(self) -> float: ...

class Guard:
    def __init__(
        self,
        robot: _HasTree,
        *,
        deceleration: npt.ArrayLike,
        period: float = ...,
        reaction: float = ...,
        most_age: float = ...,
        margin: float = ...,
        added_margin: float = ...,
        tries: int = ...,
        work_budget: int = ...,
        check_self: bool = ...,
        check_scene: bool = ...,
    ) -> None: ...
    def follow(self, trajectory: JointTrajectory) -> None: ...
    def ask(self, scene: LiveScene, now: float, path_time: float, path_speed: float) -> GuardAnswer: ...
    def look_ahead(self, scene: LiveScene, now: float, path_time: float) -> AheadAnswer: ...
