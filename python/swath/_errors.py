# SPDX-License-Identifier: GPL-3.0-or-later
"""The one error of the package."""

from __future__ import annotations


class Error(Exception):
    """What is wrong, where, and what to do.

    what: the fault. where: file, record, row or option. hint: what to do; may be empty. code: the program's exit code for it, 1 bad data,
    2 bad usage.
    """

    def __init__(self, what: str, where: str = "", hint: str = "", code: int = 1) -> None:
        self.what = what
        self.where = where
        self.hint = hint
        self.code = code
        super().__init__((f"{where}: {what}" if where else what) + (f"\n  hint: {hint}" if hint else ""))

    def __reduce__(self) -> tuple[type[Error], tuple[str, str, str, int]]:
        return Error, (self.what, self.where, self.hint, self.code)


def usage_error(what: str, where: str = "", hint: str = "") -> Error:
    """An error of the call."""
    return Error(what, where, hint, 2)
