"""Options as nested dictionaries."""

from __future__ import annotations

import os
from typing import Any, List, Mapping, Optional

from . import _glint
from ._errors import InputError


def settings(config: Optional[Mapping[str, Any]], prefix: str = "") -> List[str]:
    """{"refine": {"levels": 2}} or {"refine.levels": 2} as ["refine.levels=2"]."""
    if config is None:
        return []
    if not isinstance(config, Mapping):
        raise InputError(f"config: expected a dictionary, found {type(config).__name__}", record="config")
    lines: List[str] = []
    for key, value in config.items():
        path = f"{prefix}{key}"
        if isinstance(value, Mapping):
            lines += settings(value, path + ".")
        else:
            lines.append(f"{path}={_text(value)}")
    return lines


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_text(item) for item in value) + "]"
    return str(value)


def config_yaml(config: Optional[Mapping[str, Any]] = None, *, file: Optional["os.PathLike[str] | str"] = None) -> str:
    """Every option with its value, help, unit and range, as commented YAML.

    Args:
        config: options to change, nested or with dotted names: {"refine": {"levels": 2}}, {"refine.levels": 2}.
        file: YAML file with options, applied before `config`.

    Raises InputError that lists every unknown name and every value out of range.
    """
    return _glint.config_yaml(os.fspath(file or ""), settings(config))
