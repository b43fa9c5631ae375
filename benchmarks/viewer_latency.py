"""From a drag to new positions in the viewer.

    python benchmarks/viewer_latency.py [SCENE] [CHAIN]

A client sends drags over the wire, as the browser does, one after the other. Needs viser.
Two times a drag [ms]: until the session has the new positions (decoding, waking a thread, solving),
and until they are drawn, that is on their way to the page.
"""

import sys
import time
from pathlib import Path
from threading import Event
from typing import Any

import msgspec
import numpy as np
import viser
from viser import _messages as wire
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from limbik.core.bodyscene import read_any
from limbik.core.registry import Registry
from limbik.plugins.viewer.axes import to_page
from limbik.plugins.viewer.server import Viewer
from limbik.plugins.viewer.session import Session

SCENE = Path(__file__).parents[1] / "configs" / "body.yaml"
DRAGS, FIRST = 400, 20  # the first ones are not counted


def main(scene: str = str(SCENE), chain: str = "") -> None:
    """Drag a goal round in a small curve."""
    registry = Registry()
    session = Session(read_any(scene, registry), registry)
    viewer = Viewer(session, port=0)
    name = chain or session.selected
    one, page = session.chains[name], viewer.page
    start, size = one.to_world(one.goal), 0.05 * one.setup.chain.length
    solved, drawn = Timed(session.solve), Timed(page.act)
    timed: tuple[Any, Any] = session, page
    timed[0].solve, timed[1].act = solved, drawn
    versions = [Subprotocol(f"viser-v{viser.__version__}")]
    with connect(viewer.url.replace("http", "ws"), subprotocols=versions, max_size=None) as line:
        times = []
        grabbed = wire.TransformControlsDragStartMessage(f"/{name}-goal")
        line.send(msgspec.msgpack.encode(grabbed.as_serializable_dict()))
        for step in range(DRAGS + FIRST):
            way = np.array([np.sin(step / 17), np.cos(step / 11), np.sin(step / 23)])
            x, y, z = to_page(start + size * way).tolist()
            drag = wire.TransformControlsUpdateMessage(
                f"/{name}-goal", (1.0, 0.0, 0.0, 0.0), (x, y, z)
            )
            data = msgspec.msgpack.encode(drag.as_serializable_dict())
            sent = time.perf_counter()
            line.send(data)
            times.append((solved.next() - sent, drawn.next() - sent))
            time.sleep(0.02)  # a browser sends at most 20 drags a second
    viewer.close()
    shares = np.percentile(1e3 * np.array(times[FIRST:]), [50, 95, 99], axis=0).T
    for what, row in zip(("positions", "drawn"), shares, strict=True):
        print(f"{what:10} median {row[0]:.2f}  95 % {row[1]:.2f}  99 % {row[2]:.2f} ms")


class Timed:
    """A function whose end is waited for.

    Args:
        function: The function.
    """

    def __init__(self, function: Any) -> None:
        self._function, self._done, self._at = function, Event(), 0.0

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Call it."""
        found = self._function(*arguments, **named)
        self._at = time.perf_counter()
        self._done.set()
        return found

    def next(self) -> float:
        """Wait for its next end and return when that was."""
        assert self._done.wait(20.0)
        self._done.clear()
        return self._at


if __name__ == "__main__":
    main(*sys.argv[1:])
