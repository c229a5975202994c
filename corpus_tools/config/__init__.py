"""Configs: registered sections of values, files, differences, schema."""

from corpus_tools.config.files import config_text, load_config, write_config
from corpus_tools.config.model import (
    SCHEMA,
    Config,
    ConfigBase,
    config_diff,
    config_from_dict,
    config_schema,
    config_with,
)
from corpus_tools.config.section import SECTIONS, Section, section

__all__ = [
    "SCHEMA",
    "SECTIONS",
    "Config",
    "ConfigBase",
    "Section",
    "config_diff",
    "config_from_dict",
    "config_schema",
    "config_text",
    "config_with",
    "load_config",
    "section",
    "write_config",
]
