"""The hand's hold on the window: when it drags, when it rests, and when its gesture is over."""

from __future__ import annotations

import time

from imgui_bundle import imgui

from relgloss_view.viewer.drawing.draft_scale import DraftScale
from relgloss_view.viewer.shell import sliders
from relgloss_view.viewer.state.model import Model


class Hold:
    """Notes what the hand holds, frame by frame; a change that it makes is one step of undo."""

    def __init__(self, model: Model, draft_scale: DraftScale) -> None:
        self.model, self.draft_scale = model, draft_scale
        self._held_at_s = 0.0  #: when the hand last held something
        self.rest_awaited = (
            False  #: whether work for an idle window waits until the hand has rested
        )

    def each_frame(self, *, typing: bool) -> None:
        """Note the hand's hold; its gesture ends when it lets go, and not between two clicks.

        typing: readings are being typed, whose field has the keyboard all the time; shaders get
        ready meanwhile.
        """
        model = self.model
        pressed = any(imgui.is_mouse_down(button) for button in range(3))
        active = imgui.is_any_item_active()
        if sliders.take_moved():
            model.hold()
        again = imgui.is_mouse_double_clicked(imgui.MouseButton_.left)
        if self._rested and not (active or model.held or again):
            model.history.end_gesture()
        if pressed or (active and not typing):
            self._held_at_s = time.monotonic()
        carries = imgui.get_drag_drop_payload_py_id() is not None  # which changes no picture yet
        model.dragging = (pressed and active and not carries) or model.held
        if model.dragging:
            self.draft_scale.drag()
        else:
            self.draft_scale.rest()

    def rested(self) -> bool:
        """Whether work may hold up the window: its pause would part the clicks of a hand."""
        self.rest_awaited = not self._rested
        return not self.rest_awaited

    @property
    def _rested(self) -> bool:
        """Whether the hand let go so long ago that a click now begins another gesture.

        A second click may reach the window two frames late, one for each press and release.
        """
        wait_s = imgui.get_io().mouse_double_click_time + 2.0 * self.model.frame_s
        return time.monotonic() - self._held_at_s > wait_s
