# SPDX-License-Identifier: BSD-3-Clause
"""Poses as 4x4 matrices."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:  # numpy.typing takes 10 ms to import
    import numpy.typing as npt


def pose(
    position: npt.ArrayLike = (0.0, 0.0, 0.0),
    rpy: npt.ArrayLike | None = None,
    *,
    quaternion: npt.ArrayLike | None = None,
) -> npt.NDArray[np.float64]:
    """A pose as a 4x4 matrix.

    ``rpy`` are the angles (rad) of turns about the fixed axes x, y and z, one after the other, as in URDF;
    ``quaternion`` is x, y, z, w, as in ROS, and is normalised.
    """
    if rpy is not None and quaternion is not None:
        raise ValueError("rpy and quaternion are given; one of them is the rotation")
    out = np.eye(4)
    out[:3, 3] = _numbers(position, 3, "position")
    if rpy is not None:
        roll, pitch, yaw = _numbers(rpy, 3, "rpy")
        out[:3, :3] = _turn(2, yaw) @ _turn(1, pitch) @ _turn(0, roll)
    if quaternion is not None:
        q = _numbers(quaternion, 4, "quaternion")
        length = float(np.linalg.norm(q))
        if not length > 1e-9:
            raise ValueError("quaternion is zero")
        x, y, z, w = q / length
        out[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    return out


def _numbers(value: npt.ArrayLike, count: int, what: str) -> npt.NDArray[np.float64]:
    array = np.asarray(value, dtype=np.float64)
    if array.shape != (count,):
        raise ValueError(f"{what} has shape {array.shape}, not ({count},)")
    if not np.isfinite(array).all():
        raise ValueError(f"{what} has an entry that is not finite")
    return array


def _turn(axis: int, angle: float) -> npt.NDArray[np.float64]:
    c, s = np.cos(angle), np.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    out = np.eye(3)
    out[i, i] = out[j, j] = c
    out[i, j], out[j, i] = -s, s
    return out
