# SPDX-License-Identifier: BSD-3-Clause
"""Answers of a guard: what the controller of a robot may do until the next one."""
import dataclasses

from ._enums import GuardReason


@dataclasses.dataclass(frozen=True)
class Separation:
    """The lengths of which ISO 13855 and ISO/TS 15066 make the separation from a person, m: upper bounds."""

    human_reacting: float
    """How far the fastest object gets, from when it was seen until the robot brakes."""
    human_stopping: float
    """How far the same object gets while the robot stops."""
    robot_reacting: float
    """How far a point of the robot gets until it brakes."""
    robot_stopping: float
    """How far a point of the robot gets while it stops."""
    object: float
    """The largest tolerance of an object."""
    robot: float
    """How far tolerances of joints and base move a point of the robot."""

    @property
    def sum(self) -> float:
        """The separation: the sum of all."""
        return sum(dataclasses.astuple(self))


class _Answer:
    def __bool__(self) -> bool:
        raise TypeError("an answer is neither true nor false: ask for its speed, run_until, certified or all_free")


@dataclasses.dataclass(frozen=True)
class GuardAnswer(_Answer):
    """How the robot may go on until `valid_until`: Guard.ask()."""

    speed: float
    """Largest factor on the trajectory's own speed that is certified, 0 to 1; 0: stop now, by `braking`."""
    valid_until: float
    """Until then the answer counts; after it the robot brakes to a stop. By the caller's clock, s."""
    braking: float
    """How fast the factor falls while the robot brakes, 1/s; infinite where nothing moves."""
    stop_time: float
    """From now on until the robot stands, if it goes on at `speed` as long as it may, s."""
    stop_at: float
    """The trajectory's time at which it then stands."""
    certified: bool
    """Whether all of this is proven; False only with speed 0: the robot brakes on what was proven before."""
    reason: GuardReason
    """Why the speed is no larger."""
    pair: "tuple[str, str] | None"
    """Names of the bodies that may come too near; None where the reason is another."""
    near_at: float
    """The trajectory's time at which they may, at a speed that was refused."""
    separation: Separation
    """The separation by the standards, for `speed`."""
    tests: int
    """Work of the answer."""


@dataclasses.dataclass(frozen=True)
class AheadAnswer(_Answer):
    """How far ahead the trajectory is free at its full speed: Guard.look_ahead()."""

    free_until: float
    """The trajectory's time before which nothing comes too near; its end if all is free."""
    run_until: float
    """Until then the robot may go on: a stop that begins no later ends before `free_until`. It may be past already."""
    braking: float
    """How fast the factor falls while the robot brakes, 1/s."""
    all_free: bool
    """Whether all of the trajectory is free."""
    reason: GuardReason
    """Why it is not."""
    pair: "tuple[str, str] | None"
    """Names of the bodies that may come too near; None where the reason is another."""
    tests: int
    """Work of the answer."""
