"""Calls the real GLSL functions over arrays, so that tests transcribe none of them."""

from __future__ import annotations

from relgloss_view.picture.gpu.evaluate import evaluate

__all__ = ["evaluate"]
