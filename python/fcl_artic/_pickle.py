# SPDX-License-Identifier: BSD-3-Clause
"""Objects that are pickled as what they were made by."""
from __future__ import annotations

from typing import Any

from . import _fcl_artic as _ext


def made(owner: Any, maker: str, arguments: tuple[Any, ...]) -> Any:
    """The object that the owner's member `maker` makes of the arguments; without an owner, the module's function does."""
    return getattr(_ext if owner is None else owner, maker)(*arguments)
