"""Debian's PyTorch multiplies with generic BLAS; with OpenBLAS in its place it is four times as quick."""

import os
import pathlib
import platform
import sys

FOLDER = pathlib.Path(f"/usr/lib/{platform.machine()}-linux-gnu/openblas-pthread")


def use(threads=1):
    """Starts the program again with OpenBLAS, where it is installed; before torch is imported."""
    paths = os.environ.get("LD_LIBRARY_PATH", "").split(":")
    if FOLDER.is_dir() and str(FOLDER) not in paths:
        os.environ["LD_LIBRARY_PATH"] = ":".join([str(FOLDER)] + [path for path in paths if path])
        os.environ.setdefault("OPENBLAS_NUM_THREADS", str(threads))
        os.execv(sys.executable, [sys.executable] + sys.argv)
