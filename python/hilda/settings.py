# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of integrators as the options of the program."""

from __future__ import annotations

import difflib
from typing import Any, Iterable, Mapping

import numpy

from . import _hilda
from .errors import UsageError


def settings_as_text(where: str, keywords: Iterable[str], settings: Mapping[str, Any]) -> dict[str, str]:
    """The texts of the settings by the names of their options without the dashes.

    None and False stand for the default. Raises UsageError for a key that is not a setting, with the nearest one of
    the settings and the other keywords, and for a switch that is not True or False.
    """
    known = _hilda.setting_is_switch()
    for key in settings:
        if key not in known:
            near = difflib.get_close_matches(key, [*known, *keywords], 1)
            raise UsageError(f"{where}: unknown keyword {key!r}" + (f"; did you mean {near[0]!r}?" if near else
                             f"; it has {', '.join([*keywords, *sorted(known)])}"))
    given = {}
    for key, value in settings.items():
        if known[key] and value is not None:
            if not isinstance(value, (bool, numpy.bool_)):
                raise UsageError(f"{where}: {key} must be True or False, got {value!r}")
            if not value:
                continue
        if value is not None:
            given[key.replace("_", "-")] = "" if known[key] else str(value)
    return given
