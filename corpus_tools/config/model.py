"""A config: every value explicit, a schema number, and where it came from."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, create_model

from corpus_tools.config import motion_sections, sections  # noqa: F401  they enter themselves, in this order
from corpus_tools.config.section import SECTIONS
from corpus_tools.core import ConfigError
from corpus_tools.core.errors import suggestion

__all__ = [
    "SCHEMA",
    "Config",
    "ConfigBase",
    "config_diff",
    "config_from_dict",
    "config_schema",
    "config_with",
]

SCHEMA = 1
"""Number of the layout of config files; older numbers are migrated, newer ones refused."""

LONGEST_SHOWN = 60
"""Characters of a wrong value that a sentence repeats."""


class ConfigBase(BaseModel):
    """Schema number, provenance, and one attribute per registered section."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    schema_: int = Field(
        SCHEMA, alias="schema", ge=1, le=SCHEMA, strict=True, description="Layout of this file."
    )
    provenance: dict[str, Any] = Field(default_factory=dict, description="Corpus and code that made it.")

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...

    def values(self) -> dict[str, Any]:
        """Return sections and their values as plain data, without provenance."""
        return self.model_dump(by_alias=True, exclude={"provenance"}, mode="json")


_fields: dict[str, Any] = {name: (cls, Field(default_factory=cls)) for name, cls in SECTIONS.items()}

Config: type[ConfigBase] = create_model("Config", __base__=ConfigBase, **_fields)
"""The config model: made from the registered sections, so that a new section needs no change here."""


def _known_keys(place: tuple[Any, ...]) -> list[str]:
    if not place:
        return ["schema", "provenance", *SECTIONS]
    if place[0] in SECTIONS:
        return list(SECTIONS[str(place[0])].model_fields)
    return []


def _shown(value: Any) -> str:
    """Return a value for a sentence: a long one by its beginning."""
    text = repr(value)
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}..."


def _sentence(error: Mapping[str, Any], where: str, options: Mapping[str, str]) -> str:
    place = tuple(error["loc"])
    key = ".".join(str(p) for p in place)
    if error["type"] == "extra_forbidden":
        known = _known_keys(place[:-1])
        hint = suggestion(str(place[-1]), known) or f"; known here: {', '.join(known)}."
        return f"{where}: unknown key '{key}'{hint}"
    what = str(error["msg"]).removeprefix("Value error, ")
    what = f"{what[0].lower()}{what[1:]}."
    if key in options:
        return f"{options[key]} {_typed(error.get('input'))}: {what.replace('input should', 'it should', 1)}"
    return f"{where}: '{key}' is {_shown(error.get('input'))}: {what}"


def _typed(value: Any) -> str:
    """Return a wrong value as it was typed on a command line."""
    return f"{value:g}" if isinstance(value, float) else _shown(value).strip("'\"")


def config_from_dict(
    data: Mapping[str, Any], where: str = "config", options: Mapping[str, str] | None = None
) -> ConfigBase:
    """Make a config from plain data.

    Parameters
    ----------
    data : mapping
    where : str
        What messages name as the place of a mistake.
    options : mapping of "section.key" to str, optional
        Values that came from options of a command line: messages name those instead.

    Raises
    ------
    ConfigError
        Unknown or misspelt keys, or values out of range: one sentence on the first, and how many more.
    """
    try:
        return Config.model_validate(dict(data))
    except ValidationError as error:
        first, *others = error.errors(include_url=False)
        sentence = _sentence(first, where, options or {})
        if others:
            wrong = "is" if len(others) == 1 else "are"
            sentence = f"{sentence.rstrip('.?')}; {len(others)} more of its values {wrong} wrong."
        raise ConfigError(sentence) from None


def config_with(
    config: ConfigBase, *, options: Mapping[str, str] | None = None, **changes: Any
) -> ConfigBase:
    """Return a copy with ``section__key=value`` changes applied and checked.

    Parameters
    ----------
    config : config
    options : mapping of "section__key" to str, optional
        The options of a command line that changes came from, such as "--fps": messages name those.
    changes
    """
    data = config.model_dump(by_alias=True, mode="json")
    for path, value in changes.items():
        name, _, key = path.partition("__")
        data[name] = {**data[name], key: value}
    typed = {key.replace("__", "."): option for key, option in (options or {}).items() if key in changes}
    return config_from_dict(data, options=typed)


def config_diff(before: ConfigBase, after: ConfigBase) -> list[tuple[str, Any, Any]]:
    """Return (key, value before, value after) of every value that differs, provenance left out."""
    old, new = before.values(), after.values()
    rows: list[tuple[str, Any, Any]] = []
    for name in SECTIONS:
        for key in SECTIONS[name].model_fields:
            if old[name][key] != new[name][key]:
                rows.append((f"{name}.{key}", old[name][key], new[name][key]))
    return rows


def config_schema() -> dict[str, Any]:
    """Return the JSON schema of a config file."""
    schema: dict[str, Any] = json.loads(json.dumps(Config.model_json_schema(by_alias=True), sort_keys=True))
    return schema
