# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How every record of a scene is made: frozen, by keyword, refusing what it does not know."""

from pydantic import ConfigDict
from pydantic.dataclasses import dataclass

record = dataclass(frozen=True, kw_only=True, config=ConfigDict(extra="forbid", str_strip_whitespace=True))
