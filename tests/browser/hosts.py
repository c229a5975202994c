"""Servers that a person may put a view behind, each a process of its own: JupyterLab and `panel serve`."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import urllib.request
from collections.abc import Sequence
from pathlib import Path

PROJECT = Path(__file__).parents[2]


def start_lab(folder: Path, port: int) -> tuple[subprocess.Popen[bytes], str]:
    """Start JupyterLab in a folder as `make lab` does; return the process and the address of its files."""
    settings = folder / "lab"
    settings.mkdir()
    (settings / "overrides.json").write_text((PROJECT / ".ci/lab-overrides.json").read_text())
    options = [
        "jupyterlab",
        "--no-browser",
        "--allow-root",
        f"--ServerApp.port={port}",
        "--ServerApp.ip=127.0.0.1",
        "--IdentityProvider.token=widget",
        f"--ServerApp.root_dir={folder}",
        f"--LabApp.app_settings_dir={settings}",
        "--LabApp.extension_manager=readonly",
    ]
    process = start(options, folder, f"http://127.0.0.1:{port}/api?token=widget")
    return process, f"http://127.0.0.1:{port}/lab/tree/{{}}?token=widget"


def start_panel(script: Path, port: int) -> tuple[subprocess.Popen[bytes], str]:
    """Start `panel serve` for a script; return the process and its address."""
    options = ["panel", "serve", script.name, "--port", str(port), "--address", "127.0.0.1"]
    options += ["--allow-websocket-origin", f"127.0.0.1:{port}"]
    process = start(options, script.parent, f"http://127.0.0.1:{port}/static/js/bokeh.min.js")
    return process, f"http://127.0.0.1:{port}/{script.stem}"


def start(command: list[str], folder: Path, ready: str) -> subprocess.Popen[bytes]:
    """Start a server of the project in a folder, wait for an address, return the process."""
    paths = os.pathsep.join(p for p in (str(Path.cwd()), os.environ.get("PYTHONPATH", "")) if p)
    private = {f"JUPYTER_{name}_DIR": str(folder / name.lower()) for name in ("CONFIG", "DATA", "RUNTIME")}
    environment = {**os.environ, **private, "PYTHONPATH": paths, "IPYTHONDIR": str(folder / "ipython")}
    environment["PANEL_INLINE"] = "true"  # as make lab does
    with (folder / "log.txt").open("wb") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", *command], cwd=folder, env=environment, stdout=log, stderr=log
        )
    for _ in range(600):
        try:
            urllib.request.urlopen(ready, timeout=5).close()
            return process
        except OSError:
            assert process.poll() is None, (folder / "log.txt").read_text()
            try:
                process.wait(0.1)
            except subprocess.TimeoutExpired:
                continue
    process.terminate()
    raise AssertionError((folder / "log.txt").read_text())


def stop(process: subprocess.Popen[bytes]) -> None:
    """End a server that was started here."""
    process.terminate()
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def write_notebook(path: Path, sources: Sequence[str]) -> None:
    """Write a notebook of code cells."""
    cells = [
        {
            "cell_type": "code",
            "id": f"c{k}",
            "source": c,
            "metadata": {},
            "outputs": [],
            "execution_count": None,
        }
        for k, c in enumerate(sources)
    ]
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    path.write_text(
        json.dumps({"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5})
    )
