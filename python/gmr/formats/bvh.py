"""BVH, the Biovision hierarchy: the text format that nearly every motion capture program writes."""

from gmr.formats.bvh_reader import read_bvh
from gmr.formats.bvh_writer import bvh_chunks, write_bvh

__all__ = ["bvh_chunks", "read_bvh", "write_bvh"]
