# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of integrators as the options of the program."""

from __future__ import annotations

from typing import Any, Mapping

from . import _hilda
from .errors import UsageError


def settings_as_text(where: str, settings: Mapping[str, Any]) -> dict[str, str]:
    """The texts of the settings by the names of their options without the dashes.

    None and False stand for the default. Raises UsageError for a key that is not a setting.
    """
    known = _hilda.setting_names()
    if unknown := [key for key in settings if key not in known]:
        raise UsageError(f"{where}: unknown keys {', '.join(unknown)}; known settings are {', '.join(sorted(known))}")
    return {key.replace("_", "-"): str(value) for key, value in settings.items() if value is not None and value is not False}
