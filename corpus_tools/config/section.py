"""What every section of a config has in common, and the registry of them all."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, ValidationInfo, field_validator

from corpus_tools.core import Registry

__all__ = ["SECTIONS", "Section", "section"]


class Section(BaseModel):
    """Base of every section: unknown keys are refused, values are checked, instances do not change."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @field_validator("*", mode="before")
    @classmethod
    def _of_its_kind(cls, value: Any, info: ValidationInfo) -> Any:
        """Refuse texts and switches for numbers, and numbers for switches, which pydantic would turn over."""
        wanted = cls.model_fields[str(info.field_name)].annotation
        of_each = get_args(get_args(wanted)[0])[:1] if get_origin(wanted) is tuple else (wanted,)
        for one in value if get_origin(wanted) is tuple and isinstance(value, list | tuple) else [value]:
            if of_each[0] in (int, float) and isinstance(one, bool | str):
                raise ValueError("a number without quotes was expected")
            if of_each[0] is bool and not isinstance(one, bool):
                raise ValueError("true or false was expected, without quotes")
        return value


SECTIONS: Registry[type[Section]] = Registry("config section")

S = TypeVar("S", bound=type[Section])


def section(name: str) -> Callable[[S], S]:
    """Return a decorator that registers a section under `name`."""

    def enter(cls: S) -> S:
        SECTIONS.add(name, cls)
        return cls

    return enter
