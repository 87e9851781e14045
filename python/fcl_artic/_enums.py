# SPDX-License-Identifier: BSD-3-Clause
"""Enumerations. Where one is taken as an argument, its value as text is taken too: ``mode="any"``."""
import enum


class Status(enum.IntEnum):
    """The verdict of a query; as a number in the arrays of many answers."""

    FREE = 0
    """Proven: no checked pair comes within its margin (0: touches) at any time of the motion."""
    CONTACT = 1
    """Contact, proven if ``certain``; otherwise it can't be excluded within the tolerances."""
    UNDECIDED = 2
    """The work budget ran out, or ``progress`` ended the query. The motion is proven free on [0, t_lower)."""

    def __str__(self) -> str:
        return self.name.lower()


class ContactMode(enum.Enum):
    """Which contacts a query looks for."""

    FIRST = "first"
    """The first contact of the whole motion."""
    ANY = "any"
    """Any contact that can be proven soon: cheaper if only the verdict matters."""
    FIRST_OF_EVERY_PAIR = "first_of_every_pair"
    """The first contact of every pair of bodies that touches."""


class VisibilityMode(enum.Enum):
    """Whether culling by visibility takes part in a query. Answers are the same bits either way."""

    OFF = "off"
    ON = "on"


class VisibilityExecutor(enum.Enum):
    """Who culls by visibility: the library's own scan conversion, or OpenGL without a window."""

    CPU = "cpu"
    OSMESA = "osmesa"
    EGL = "egl"


class Method(enum.Enum):
    """The method that solves a query. Both make the same promise."""

    STANDARD = "standard"
    REDON2004 = "redon2004"


class MotionEnclosure(enum.Enum):
    """How ``Method.REDON2004`` bounds a link's motion over a time interval."""

    INTERVAL_CHAIN = "interval_chain"
    MEAN_VALUE = "mean_value"
    TAYLOR = "taylor"


class FeatureKind(enum.Enum):
    """Kinds of features that meet at a contact, body 1's first; VOLUME if none are known."""

    VERTEX_VERTEX = "vertex-vertex"
    VERTEX_EDGE = "vertex-edge"
    EDGE_VERTEX = "edge-vertex"
    VERTEX_FACE = "vertex-face"
    FACE_VERTEX = "face-vertex"
    EDGE_EDGE = "edge-edge"
    EDGE_FACE = "edge-face"
    FACE_EDGE = "face-edge"
    FACE_FACE = "face-face"
    VOLUME = "volume"


class GuardReason(enum.Enum):
    """Why a guard's answer is no larger."""

    NONE = "none"
    """Full speed."""
    NEAR = "near"
    """Two bodies may come too near."""
    BUDGET = "budget"
    """The work budget is spent."""
    OLD_SCENE = "old_scene"
    """The scene was seen too long ago, or after now."""


class JointType(enum.Enum):
    """Kinds of joints, as in URDF."""

    FIXED = "fixed"
    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    PLANAR = "planar"
    SPHERICAL = "spherical"
    FLOATING = "floating"


class LinkPairKind(enum.Enum):
    """Whether two links touch, over all values of their joints."""

    NEVER = "never"
    """Proven apart for all values within the joints' limits."""
    ALWAYS = "always"
    """In contact in every configuration that was tried."""
    SOMETIMES = "sometimes"
    """In contact in some configurations and not in others."""
    UNPROVEN = "unproven"
    """In contact in no configuration that was tried, and yet not proven apart."""
