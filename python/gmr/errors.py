"""Everything that gmr raises, one small tree under :class:`GmrError`; each message says how to mend it."""

from __future__ import annotations

from typing import Final

__all__ = [
    "ActionletError",
    "DatasetError",
    "FormatError",
    "FormatWarning",
    "GmrError",
    "MissingExtraError",
    "SkeletonError",
    "SkinError",
    "SkinWarning",
]


class GmrError(Exception):
    """Base of all errors that gmr raises on purpose."""


class FormatError(GmrError, ValueError):
    """A file that cannot be read or written as what it claims to be.

    Args:
        what: what is wrong and how to mend it, one or two sentences.
        file: the file's name, as the user gave it; None for text without a name.
        line: 1-based line, None where the fault has no line.
        column: 1-based number of the character in that line, None where it has none.
        expected: what was expected in that place, None where the sentence says it all.
    """

    def __init__(
        self,
        what: str,
        *,
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
        expected: str | None = None,
    ) -> None:
        self.what: Final = what
        self.file: Final = file
        self.line: Final = line
        self.column: Final = column
        self.expected: Final = expected
        place = ":".join(str(part) for part in (file or "<text>", line, column) if part is not None)
        super().__init__(f"{place}: {what}")


class FormatWarning(UserWarning):
    """Something odd in a file that was read all the same; says what was done about it."""


class SkeletonError(GmrError, ValueError):
    """A skeleton that is no forest, or a joint that it does not have."""


class SkinError(GmrError, ValueError):
    """A mesh that cannot follow its joints, or transforms that do not fit it."""


class SkinWarning(UserWarning):
    """A mesh and a skeleton that fit each other oddly; says how, and what to do."""


class ActionletError(GmrError, ValueError):
    """An actionlet, a track, a score or an operation on them that cannot be, and what would mend it."""


class DatasetError(GmrError, ValueError):
    """Motions from which no database or evaluation can be made, and why."""


class MissingExtraError(GmrError, ImportError):
    """A feature needs an optional package; the message names the extra that installs it."""

    def __init__(self, package: str, extra: str, feature: str) -> None:
        super().__init__(
            f"{feature} needs the package '{package}'. Install it with: pip install 'gmr-motion[{extra}]'"
        )
        self.package: Final = package
        self.extra: Final = extra
