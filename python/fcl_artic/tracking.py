# SPDX-License-Identifier: BSD-3-Clause
"""How far a robot's joints are from what was commanded, measured from logs::

    python -m fcl_artic.tracking log.csv --robot robot.urdf

A log is a CSV file with a header. Each row has commanded and actual values of joints at one time. Prints the largest
difference of each joint and its 99.9 % quantile, and the option ``--joint-tolerance`` that covers the largest ones.
"""
from __future__ import annotations

import argparse
import csv
import dataclasses
import math
import os
import re
import sys
from collections.abc import Iterable, Sequence

import numpy as np
import numpy.typing as npt

from . import Joint, JointType, KinematicTree, load_urdf

__all__ = ["Tracking", "main", "measure", "option"]

_Doubles = npt.NDArray[np.float64]

_COMMANDED = {"commanded", "command", "cmd", "desired", "reference", "ref", "target", "setpoint"}
_ACTUAL = {"actual", "measured", "feedback", "state", "states"}
_POSITION = {"position", "positions", "pos"}
_NUMBERED = {"q", "j", "joint", "joints"}
_OTHER = {
    "velocity", "velocities", "vel", "qd", "acceleration", "accelerations", "acc", "qdd", "effort", "efforts", "torque",
    "current", "moment", "error", "time",
}
_TURNING = (JointType.REVOLUTE, JointType.CONTINUOUS)
_CURE = "say which with --joint JOINT=COMMANDED,ACTUAL"


@dataclasses.dataclass
class Tracking:
    """The measured differences of one joint, in the log's unit."""

    joint: str
    unit: str  #: "rad", "deg" or "m"
    largest: float
    quantile: float  #: 99.9 % of the rows are no farther off
    where: str  #: file and line of the largest
    rows: int


def _words(name: str) -> list[str]:
    return re.findall(r"[a-z]+|\d+", re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower())


def _joint_of(name: str, joints: Sequence[Joint]) -> str | int | None:
    """The joint that a column is about: its name, or its number in the log; None: none."""
    alone = r"(?<![A-Za-z0-9]){}(?![A-Za-z0-9])"
    named = [joint.name for joint in joints if re.search(alone.format(re.escape(joint.name)), name)]
    named.sort(key=len)
    rest = _words(name.replace(named[-1], " ") if named else name)
    if any(word in _OTHER for word in rest):
        return None
    rest = [word for word in rest if word not in _COMMANDED | _ACTUAL | _POSITION]
    if named:
        # The rest names a topic, as /joint_states or /arm_controller.
        return named[-1] if not rest or "/" in name else None
    numbers = [word for word in rest if word.isdigit()]
    known = name.startswith("/") or all(word in _NUMBERED for word in rest if not word.isdigit())
    return int(numbers[0]) if known and len(numbers) == 1 and rest[-1] == numbers[0] else None


def _one(columns: list[str], joint: str, side: str, path: str) -> str:
    if len(columns) > 1:
        both = " and ".join(f"'{name}'" for name in columns[:2])
        raise ValueError(f"'{path}': {both} may both be the {side} values of joint '{joint}': {_CURE}")
    return columns[0]


def _pairs(header: Sequence[str], joints: Sequence[Joint], path: str) -> dict[str, tuple[str, str]]:
    """Names of the commanded and the actual column of each joint that has both."""
    found: dict[str | int, tuple[list[str], list[str]]] = {}
    for name in header:
        joint = _joint_of(name, joints)
        if joint is not None:
            commanded = any(word in _COMMANDED for word in _words(name))
            found.setdefault(joint, ([], []))[0 if commanded else 1].append(name)
    both = {joint: columns for joint, columns in found.items() if columns[0] and columns[1]}
    numbers = sorted(joint for joint in both if isinstance(joint, int))
    free = [joint for joint in joints if joint.mimic is None]
    if numbers and not (numbers[0] in (0, 1) and numbers == list(range(numbers[0], numbers[0] + len(free)))):
        said = ", ".join(map(str, numbers))
        raise ValueError(f"'{path}': columns are numbered {said}, and the robot has {len(free)} joints: {_CURE}")
    if numbers and len(both) > len(numbers):
        raise ValueError(f"'{path}': some columns name their joint and others number it: {_CURE}")
    pairs = {}
    for joint, columns in both.items():
        name = free[joint - numbers[0]].name if isinstance(joint, int) else joint
        pairs[name] = (_one(columns[0], name, "commanded", path), _one(columns[1], name, "actual", path))
    if not pairs:
        said = ", ".join(header)
        raise ValueError(f"'{path}': no joint has both a commanded and an actual column among {said}: {_CURE}")
    return pairs


def _header_and_rows(path: str) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """The header, and each row with the number of its line."""
    with open(path, newline="", encoding="utf-8-sig") as file:
        lines = [(number, line.strip()) for number, line in enumerate(file, 1) if line.strip()]
    if not lines:
        raise ValueError(f"'{path}' is empty")
    first = lines[0][1].lstrip("# ")
    separator = next((mark for mark in ";\t," if mark in first), " ")
    lines[0] = (lines[0][0], first)
    rows = []
    table = csv.reader((line for _, line in lines), delimiter=separator, skipinitialspace=True)
    for (number, _), cells in zip(lines, table):
        rows.append((number, [cell.strip() for cell in cells]))
    header = rows[0][1]
    twice = next((name for name in header if header.count(name) > 1), None)
    if twice is not None:
        raise ValueError(f"'{path}': two columns are named '{twice}'")
    if len(rows) == 1:
        raise ValueError(f"'{path}' has a header and no row")
    return header, rows[1:]


def _number(path: str, line: int, column: str, text: str) -> float:
    where = f"'{path}' line {line}, column '{column}'"
    try:
        value = float(text)
    except ValueError:
        what = "is empty" if not text else f"is '{text}', no number"
        raise ValueError(f"{where} {what}: each row needs both values at one time") from None
    if not math.isfinite(value):
        raise ValueError(f"{where} is {text}")
    return value


def _difference(commanded: float, actual: float, joint: Joint, turn: float) -> float:
    difference = actual - commanded
    if joint.type is JointType.CONTINUOUS:
        difference = math.remainder(difference, turn)  # a log may count whole turns on one side alone
    return abs(difference)


def measure(logs: Iterable[str | os.PathLike[str]], tree: KinematicTree, degrees: bool = False,
            columns: dict[str, tuple[str, str]] | None = None) -> list[Tracking]:
    """Measures how far joints are from what was commanded, over all rows of all logs.

    ``columns`` has the names of the commanded and the actual column of each joint. Without it they are found by their
    names, as ``target_q_0`` beside ``actual_q_0`` or ``joint1/command`` beside ``joint1``. Raises a ValueError that
    names file, line and column.
    """
    joints = {joint.name: joint for joint in tree.joints if joint.type in (*_TURNING, JointType.PRISMATIC)}
    for name in columns or {}:
        if name not in joints:
            raise ValueError(f"--joint: robot '{tree.name}' has no joint '{name}' that turns or slides by one value")
    turn = 360 if degrees else 2 * math.pi
    differences: dict[str, list[float]] = {}
    places: dict[str, list[str]] = {}
    for log in logs:
        path = os.fspath(log)
        header, rows = _header_and_rows(path)
        pairs = columns or _pairs(header, list(joints.values()), path)
        for missing in (name for pair in pairs.values() for name in pair if name not in header):
            raise ValueError(f"'{path}' has no column '{missing}' among {', '.join(header)}")
        for line, cells in rows:
            if len(cells) != len(header):
                raise ValueError(f"'{path}' line {line} has {len(cells)} values, the header {len(header)} names")
        for joint, (commanded, actual) in pairs.items():
            at = header.index(commanded), header.index(actual)
            for line, cells in rows:
                values = _number(path, line, commanded, cells[at[0]]), _number(path, line, actual, cells[at[1]])
                differences.setdefault(joint, []).append(_difference(*values, joints[joint], turn))
                places.setdefault(joint, []).append(f"{path} line {line}")
    tracked = []
    for joint in (name for name in joints if name in differences):
        all_of_joint: _Doubles = np.array(differences[joint])
        most = int(all_of_joint.argmax())
        unit = "m" if joints[joint].type is JointType.PRISMATIC else "deg" if degrees else "rad"
        quantile = float(np.quantile(all_of_joint, 0.999, method="inverted_cdf"))
        rows_of_joint = len(all_of_joint)
        tracked.append(Tracking(joint, unit, float(all_of_joint[most]), quantile, places[joint][most], rows_of_joint))
    return tracked


def _rounded_up(value: float) -> str:
    """Three digits, never less than the value."""
    if value == 0:
        return "0"
    digits = 2 - math.floor(math.log10(value))
    up = math.ceil(value * 10.0**digits)
    text = f"{up / 10.0**digits:.{max(digits, 0)}f}"
    return text if float(text) >= value else f"{(up + 1) / 10.0**digits:.{max(digits, 0)}f}"


def option(tracked: Sequence[Tracking], tree: KinematicTree) -> str:
    """The option that covers each joint's largest difference. Where a joint follows another, it counts for that one."""
    least: dict[str, tuple[float, str]] = {}
    for one in tracked:
        mimic = tree.joint(one.joint).mimic
        if mimic is not None and mimic.multiplier == 0:
            raise ValueError(f"joint '{one.joint}' follows '{mimic.master}' by 0: no tolerance covers its error")
        name = one.joint if mimic is None else mimic.master
        value = one.largest if mimic is None else one.largest / abs(mimic.multiplier)
        least[name] = max(least.get(name, (0.0, one.unit)), (value, one.unit))
    parts = (f"{name}={_rounded_up(value)}{unit}" for name, (value, unit) in least.items())
    return "--joint-tolerance " + ",".join(parts)


def _notes(tracked: Sequence[Tracking], tree: KinematicTree) -> list[str]:
    notes = []
    measured = {one.joint for one in tracked}
    left_out = [joint.name for joint in tree.joints
                if joint.type is not JointType.FIXED and joint.mimic is None and joint.name not in measured]
    if left_out:
        notes.append(f"no tolerance is measured of {', '.join(left_out)}: without an option each counts as exact")
    if any(one.largest == 0 for one in tracked):
        same = ", ".join(one.joint for one in tracked if one.largest == 0)
        notes.append(f"commanded and actual values of {same} are the same in every row: are they two signals?")
    if any(one.rows < 1000 for one in tracked):
        notes.append("with less than 1000 rows the 99.9 % quantile is the largest difference")
    for one in tracked:
        if one.largest > 3 * one.quantile:
            notes.append(f"{one.joint}: few rows are far off, the most in {one.where}: look there before you take it")
    notes.append("the largest differences of these logs: take more for motions that they lack, and between their rows")
    return notes


def _read_columns(texts: Sequence[str]) -> dict[str, tuple[str, str]]:
    columns = {}
    for text in texts:
        joint, equals, names = text.partition("=")
        both = names.split(",")
        if not joint or not equals or len(both) != 2 or not all(both):
            raise ValueError(f"--joint: '{text}' is not JOINT=COMMANDED,ACTUAL")
        if joint in columns:
            raise ValueError(f"--joint: '{joint}' is named twice")
        columns[joint] = (both[0], both[1])
    return columns


def main(arguments: Sequence[str] | None = None) -> int:
    """The program. Returns its exit status: 2 after an error."""
    parser = argparse.ArgumentParser(prog="python -m fcl_artic.tracking",
                                     description="Measures tracking errors of joints from logs, for --joint-tolerance.")
    parser.add_argument("logs", nargs="+", metavar="LOG.csv", help="CSV with a header; several count as one")
    parser.add_argument("--robot", required=True, metavar="FILE", help="URDF: names of joints, which turn, which slide")
    parser.add_argument("--degrees", action="store_true", help="angles are in degrees, else in radians")
    parser.add_argument("--joint", action="append", default=[], metavar="JOINT=COMMANDED,ACTUAL",
                        help="names of a joint's two columns; may be repeated; then no others are read")
    given = parser.parse_args(arguments)
    try:
        tree = load_urdf(given.robot).tree
        tracked = measure(given.logs, tree, given.degrees, _read_columns(given.joint))
        pasted = option(tracked, tree)
    except (OSError, RuntimeError, ValueError) as error:
        print(f"tracking: {error}", file=sys.stderr)
        return 2
    wide = max(len(one.joint) for one in tracked)
    print(f"{'joint':<{wide}}  {'largest':>12}  {'99.9 %':>12}        rows  largest in")
    for one in tracked:
        numbers = f"{one.largest:>12.6g}  {one.quantile:>12.6g} {one.unit:<3} {one.rows:>7}"
        print(f"{one.joint:<{wide}}  {numbers}  {one.where}")
    print(pasted)
    for note in _notes(tracked, tree):
        print(f"note: {note}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
