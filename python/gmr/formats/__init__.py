"""The door: files, folders, bytes and streams become motions, and motions become files."""

from __future__ import annotations

from gmr.formats.characters import read_character, write_character
from gmr.formats.folder import Takes, motion_files, read_folder
from gmr.formats.reading import read, read_markers
from gmr.formats.registry import FORMATS, Format
from gmr.formats.writing import write

__all__ = [
    "FORMATS",
    "Format",
    "Takes",
    "motion_files",
    "read",
    "read_character",
    "read_folder",
    "read_markers",
    "write",
    "write_character",
]
