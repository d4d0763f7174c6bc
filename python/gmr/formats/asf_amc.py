"""ASF and AMC, Acclaim's skeleton and motion files: the form in which CMU gives its database away."""

from gmr.formats.amc_reader import read_amc, read_asf
from gmr.formats.asf_amc_writer import amc_chunks, asf_chunks
from gmr.formats.asf_finder import find_asf, serving_asf
from gmr.formats.asf_reader import parse_asf

__all__ = ["amc_chunks", "asf_chunks", "find_asf", "parse_asf", "read_amc", "read_asf", "serving_asf"]
