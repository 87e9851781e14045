# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of answers."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from . import _fcl_artic as _ext

if TYPE_CHECKING:  # numpy.typing takes 10 ms to import
    import numpy as np
    import numpy.typing as npt


class Picture:
    """An image: ``array`` (height, width, 3) of uint8, the top row first. Notebooks show it."""

    def __init__(self, array: npt.NDArray[np.uint8]) -> None:
        self.array = array

    def png(self) -> bytes:
        """The image as the content of a PNG file."""
        return _ext._png(self.array)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the image as a PNG file. ValueError: the path ends as that of another kind of file, such as .jpg."""
        ending = os.path.splitext(os.fspath(path))[1]
        if ending.lower() not in ("", ".png"):
            raise ValueError(f"'{os.fspath(path)}' ends in '{ending}'; pictures are written as .png")
        content = self.png()
        with open(path, "wb") as file:
            file.write(content)

    def __array__(self, dtype: npt.DTypeLike = None) -> npt.NDArray[Any]:
        return self.array if dtype is None else self.array.astype(dtype)

    def _repr_png_(self) -> bytes:
        return self.png()

    def __repr__(self) -> str:
        return f"<Picture: {self.array.shape[1]} x {self.array.shape[0]} pixels>"
