"""One BLAS thread while a stage computes: equal input gives equal bytes, in a notebook as in a batch run."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

__all__ = ["one_thread"]

P = ParamSpec("P")
R = TypeVar("R")


@functools.cache
def _controller() -> ThreadpoolController:
    return ThreadpoolController()


def one_thread(stage: Callable[P, R]) -> Callable[P, R]:
    """Decorate a stage so that BLAS uses one thread in it.

    With several threads sums are taken in another order and differ in the last bits; two equal runs would
    then not give equal bytes.
    """

    @functools.wraps(stage)
    def single(*args: P.args, **kwargs: P.kwargs) -> R:
        with _controller().limit(limits=1, user_api="blas"):
            return stage(*args, **kwargs)

    return single
