# SPDX-License-Identifier: BSD-3-Clause
"""Objects that are pickled as what they were made by."""
from __future__ import annotations

from typing import Any

from . import _fcl_artic as _ext


def made(owner: Any, maker: str, arguments: tuple[Any, ...]) -> Any:
    """What the owner's member `maker`, or without an owner the function of that name, makes of the arguments."""
    return getattr(_ext if owner is None else owner, maker)(*arguments)
