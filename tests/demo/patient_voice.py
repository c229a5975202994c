"""Children of the embedded voice that say many sentences each: 2880 fresh ones would take minutes."""

from __future__ import annotations

import importlib.util
import json
import queue
import subprocess
import sys
from pathlib import Path

from corpus_tools.speech.engines import espeak_worker

_SERVE = """
import functools, importlib.util, json, sys
spec = importlib.util.spec_from_file_location("worker", sys.argv[2])
worker = importlib.util.module_from_spec(spec)
spec.loader.exec_module(worker)
sys.path.append(sys.argv[1])
reading, writing = sys.stdin.buffer, worker._private_stdout()
library, rate_hz = worker._library()
worker._set_voice = functools.cache(worker._set_voice)
count = functools.cache(lambda word: counted(library, [word])[0])
counted, worker._phone_counts = worker._phone_counts, lambda library, words: [count(w) for w in words]
while True:
    try:
        request = json.loads(worker.read_message(reading))
    except EOFError:
        break
    head, sound = worker.answer(library, rate_hz, request)
    worker.write_message(writing, json.dumps(head).encode())
    worker.write_message(writing, sound)
"""


class PatientVoice:
    """Stands where :class:`corpus_tools.speech.engines.child.Children` stands, and keeps its children.

    The library keeps traces of what it said before (noise, phase), so that closures of stops may lie some ms
    elsewhere; which phones it says does not depend on them: a test compares the two. What is the same for
    every sentence, the choice of the voice and the number of phones of a word on its own, is asked once.

    Parameters
    ----------
    n : int
        How many children: so many threads may ask at once.
    """

    def __init__(self, n: int) -> None:
        folder = Path(importlib.util.find_spec("espeakng_loader").submodule_search_locations[0]).parent
        command = [sys.executable, "-I", "-c", _SERVE, str(folder), espeak_worker.__file__]
        self._free = queue.SimpleQueue()
        self._all = [
            subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) for _ in range(n)
        ]
        for child in self._all:
            self._free.put(child)

    def ask(self, request, limit_s):
        """Return the answer to a request, and the samples."""
        child = self._free.get(timeout=limit_s)
        try:
            espeak_worker.write_message(child.stdin, json.dumps(request).encode())
            return json.loads(espeak_worker.read_message(child.stdout)), espeak_worker.read_message(
                child.stdout
            )
        finally:
            self._free.put(child)

    def close(self) -> None:
        """End the children."""
        for child in self._all:
            child.stdin.close()
            child.stdout.close()
            child.wait(10)
