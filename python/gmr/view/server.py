"""The live viewer: a local server, and the controls that its page has."""

from __future__ import annotations

import html
import threading
import time
import webbrowser
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

from gmr.view.opening import HOST, closed, opened
from gmr.view.playing import Player
from gmr.view.shown import figures_of
from gmr.view.stage import LAYERS, METHODS, Look, Stage
from gmr.view.timeline import Timeline

if TYPE_CHECKING:
    from types import TracebackType

    from gmr.skinning.blending import Method
    from gmr.skinning.character import Character
    from gmr.view.figure import Figure
    from gmr.view.shown import Shown

__all__ = ["Live", "show"]

_REDRAW = 1 / 60
"""Seconds between two looks at the clock."""
_SPEEDS = ("0.1", "0.25", "0.5", "1", "2", "4")
_PLAIN = "materials"


def show(
    shown: Shown | Iterable[Shown],
    *,
    character: Character | None = None,
    rule: str = "per_child",
    look: Look | None = None,
    port: int | None = None,
    open: bool = False,
) -> Live:
    """Shows motions and characters at an address of this machine, until :meth:`Live.stop` or the end of the
    program.

    Args:
        shown: a motion, a character or a :class:`Figure`, or several.
        character: a skin for the motions.
        rule: how bones are drawn; see :func:`gmr.bones`.
        look: what is drawn at first.
        port: None: the first free one from 8080 on; 0: any free one.
        open: open the browser.

    Raises:
        MissingExtraError: viser is not installed (the extra ``view``).
        GmrError: there is nothing to show, or the port is taken.
    """
    live = Live(figures_of(shown, character, rule), look or Look(), port)
    if open:
        webbrowser.open(live.address)
    return live


class Live:
    """A running viewer; see :func:`show`. As a context it stops at the end."""

    def __init__(self, figures: Sequence[Figure], look: Look, port: int | None = None) -> None:
        self._timeline = Timeline.of(figures)
        self._player = Player(self._timeline)
        self._figures, self._look = figures, look
        self._lock, self._ended = threading.RLock(), threading.Event()
        self._server = opened(port)
        self.address = f"http://{HOST}:{self._server.get_port()}"
        """Where a browser finds it."""
        try:
            self._stage = Stage(self._server, figures, look)
            self._add_controls()
            self._draw()
        except BaseException:
            closed(self._server)
            raise
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def wait(self) -> None:
        """Waits until it is stopped, or interrupted."""
        while not self._ended.wait(0.2):
            pass

    def stop(self) -> None:
        """Ends it."""
        self._ended.set()
        if self._thread is not threading.current_thread():
            self._thread.join(timeout=2.0)
        closed(self._server)

    def __enter__(self) -> Live:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def _run(self) -> None:
        """Moves the time line while it plays."""
        before = time.perf_counter()
        while not self._ended.wait(_REDRAW):
            now = time.perf_counter()
            with self._lock:
                changed = self._player.advance(now - before)
                if changed:
                    self._draw()
            before = now

    def _draw(self) -> None:
        """The tick that the player is at, in the scene and in the controls."""
        tick = self._player.tick
        with self._server.atomic():
            self._stage.draw(self._timeline, tick)
        self._slider.value = tick
        self._time.content = f"{tick * self._timeline.step:.2f} of {self._timeline.seconds:.2f} s"
        self._play.label = "Pause" if self._player.is_playing else "Play"

    def _add_controls(self) -> None:
        gui = self._server.gui
        gui.configure_theme(show_logo=False, show_share_button=False, control_width="medium")
        gui.set_panel_label("gmr view")
        last = self._timeline.tick_count - 1
        self._slider: Any = gui.add_slider(
            "Frame", min=0, max=last, step=1, initial_value=0, disabled=not last
        )
        self._time: Any = gui.add_markdown("")
        self._play: Any = gui.add_button("Pause", hint="Play or pause.")
        steps = gui.add_button_group(
            "Step", ("Start", "Back", "Next"), hint="To the start, a frame back, a frame on."
        )
        speed = gui.add_dropdown("Speed", _SPEEDS, initial_value="1")
        loop = gui.add_checkbox("Loop", True)
        self._slider.on_update(
            lambda event: self._asked(event, lambda: self._player.go(int(self._slider.value)))
        )
        self._play.on_click(lambda event: self._asked(event, self._player.toggle))
        steps.on_click(lambda event: self._asked(event, lambda: self._step(str(steps.value))))
        speed.on_update(lambda event: self._asked(event, lambda: self._player.run_at(float(speed.value))))
        loop.on_update(lambda event: self._asked(event, lambda: self._player.loop(bool(loop.value))))
        self._add_look(gui)
        notes = [f"{figure.name}: {note}" for figure in self._figures for note in figure.notes]
        if notes:
            # Markdown would run what a file's name says.
            items = "".join(f"<li>{html.escape(note)}</li>" for note in notes)
            gui.add_html(f'<ul style="margin: 0.5em; padding-left: 1.2em; font-size: 0.85em">{items}</ul>')

    def _add_look(self, gui: Any) -> None:
        has_skin = any(figure.worn is not None for figure in self._figures)
        for layer in LAYERS:
            if layer == "skin" and not has_skin:
                continue
            box = gui.add_checkbox(layer.capitalize(), layer in self._look.layers)
            box.on_update(
                lambda event, box=box, layer=layer: self._asked(event, lambda: self._turn(layer, box.value))
            )
        if not has_skin:
            return
        named = {method: method.upper() if method != "cor" else "CoR" for method in METHODS}
        method = gui.add_dropdown("Blending", tuple(named.values()), initial_value=named[self._look.method])
        opacity = gui.add_slider(
            "Opacity", min=0.1, max=1.0, step=0.05, initial_value=self._look.opacity, hint="Of the skin."
        )
        opacity.on_update(
            lambda event: self._asked(
                event, lambda: self._restyle(replace(self._look, opacity=float(opacity.value)))
            )
        )
        joints = dict.fromkeys(
            joint for figure in self._figures if figure.worn for joint in figure.worn.character.joint_names
        )
        weights = gui.add_dropdown(
            "Colours", (_PLAIN, *joints), initial_value=self._look.weights or _PLAIN,
            hint="Colours of the materials, or the weights of a joint from dark (0) to red (1).",
        )  # fmt: skip
        back = {label: key for key, label in named.items()}
        method.on_update(
            lambda event: self._asked(
                event, lambda: self._restyle(replace(self._look, method=cast("Method", back[method.value])))
            )
        )
        weights.on_update(
            lambda event: self._asked(
                event,
                lambda: self._restyle(
                    replace(self._look, weights=None if weights.value == _PLAIN else weights.value)
                ),
            )
        )

    def _asked(self, event: Any, act: Any) -> None:
        """Does what somebody at a browser asks for; values that the viewer sets itself ask for nothing."""
        if event.client is None:
            return
        with self._lock:
            act()
            self._draw()

    def _step(self, way: str) -> None:
        self._player.go(0 if way == "Start" else self._player.tick + (1 if way == "Next" else -1))

    def _turn(self, layer: str, on: bool) -> None:
        layers = self._look.layers | {layer} if on else self._look.layers - {layer}
        self._restyle(replace(self._look, layers=layers))

    def _restyle(self, look: Look) -> None:
        with self._server.atomic():
            self._stage.look_like(look)
        self._look = look
