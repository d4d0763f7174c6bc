"""Skinning: a mesh follows a skeleton."""

from __future__ import annotations

from gmr.skinning.blending import Hemisphere, Method, Skin

__all__ = ["Hemisphere", "Method", "Skin"]
