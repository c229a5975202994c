"""Can this machine draw off-screen? Asked in a child process: without the right half of Mesa VTK dies."""

from __future__ import annotations

import functools
import os
import signal
import subprocess
import sys
from dataclasses import dataclass

__all__ = ["OffscreenStatus", "apply_window", "probe_offscreen"]

DRAW = """
import numpy as np, pyvista as pv
p = pv.Plotter(off_screen=True, window_size=(32, 32))
p.set_background("black")
p.add_mesh(pv.Sphere(), color="white", lighting=False)
picture = np.asarray(p.screenshot(return_img=True))
assert picture.max() > 200 and picture.min() < 50, "the picture is empty"
print("drawn")
"""
WINDOW_VARIABLE = "VTK_DEFAULT_OPENGL_WINDOW"
PACKAGES = {
    "vtkEGLRenderWindow": "libegl1 libgl1-mesa-dri",
    "vtkOSOpenGLRenderWindow": "libosmesa6",
}


@dataclass(frozen=True, slots=True)
class OffscreenStatus:
    """What the probe found.

    Attributes
    ----------
    ok : bool
    reason : str
        One sentence when not `ok`: what happened and what to install.
    package : str
        Debian packages that would mend it; empty when `ok`.
    window : str
        VTK render window class that worked; empty for VTK's own choice.
    """

    ok: bool
    reason: str = ""
    package: str = ""
    window: str = ""


@functools.cache
def probe_offscreen(timeout_s: float = 60.0) -> OffscreenStatus:
    """Draw a small picture in a child process; survives the child's death by a signal.

    The window classes of EGL and OSMesa are tried in turn, VTK's own choice first where a display is set.
    The answer is remembered for the life of this process.

    Parameters
    ----------
    timeout_s : float, s
        For each try.
    """
    windows = ["", *PACKAGES] if os.environ.get("DISPLAY") or sys.platform != "linux" else list(PACKAGES)
    failures = []
    for window in windows:
        failure = _try(window, timeout_s)
        if failure is None:
            return OffscreenStatus(True, window=window)
        failures.append(failure)
    package = PACKAGES["vtkEGLRenderWindow"]
    return OffscreenStatus(
        False,
        f"Off-screen drawing does not work here ({failures[0]}); on Debian or Ubuntu install {package} "
        f"(apt-get install {package}), or {PACKAGES['vtkOSOpenGLRenderWindow']}.",
        package,
    )


def apply_window(status: OffscreenStatus) -> None:
    """Let VTK use the window class that worked in the probe, unless the user has set one."""
    if status.window:
        os.environ.setdefault(WINDOW_VARIABLE, status.window)


def _try(window: str, timeout_s: float) -> str | None:
    """Return None when a picture was drawn, else what happened in a few words."""
    environment = dict(os.environ)
    if window:
        environment[WINDOW_VARIABLE] = window
    try:
        done = subprocess.run(
            [sys.executable, "-c", DRAW],
            env=environment,
            capture_output=True,
            text=True,
            timeout=timeout_s,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"no picture within {timeout_s:g} s"
    if done.returncode == 0 and "drawn" in done.stdout:
        return None
    if done.returncode < 0:
        return f"drawing ended by {signal.Signals(-done.returncode).name}"
    last = [line for line in done.stderr.splitlines() if line.strip()]
    return last[-1].strip() if last else f"exit code {done.returncode}"
