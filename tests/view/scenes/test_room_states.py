"""The room of 3.4 over its whole range."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, InputError, constrained_delaunay
from unstruct.view import check_frame
from unstruct.view.scenes.room_states import ROOM_CORNERS, ROOM_WALLS, ROOM_X, ROOM_Y, room_state


@pytest.mark.parametrize("wall", list(ROOM_WALLS))
def test_the_whole_range_of_the_room(wall: str) -> None:
    hiding = 0
    for x in ROOM_X:
        for y in ROOM_Y:
            frames = room_state(x, y, wall)
            for one in frames:
                check_frame(one)
            domain = Domain([*ROOM_CORNERS, (x, y)], [(0, 1), (1, 2), (2, 3), (3, 0)], inner=ROOM_WALLS[wall])
            expected = constrained_delaunay(domain)
            assert len(frames) == expected.size + 1
            cells = np.sort(np.asarray(frames[-1]["items"][0]["data"]).reshape(len(frames) - 1, -1))
            area = np.sort(expected.points[expected.simplices].reshape(expected.size, -1))
            found = sorted(map(tuple, cells.round(9).tolist()))
            ties = any("on the circle" in one["caption"] for one in frames)
            assert ties or found == sorted(map(tuple, area.round(9).tolist()))
            hiding += not frames[-1]["number"].endswith(": 0")
    assert (hiding > 5) == (wall == "a wall") and (hiding == 0) == (wall == "no wall")


def test_the_page_s_point_is_hidden_by_the_wall_alone() -> None:
    with_wall, without = room_state(2.0, 1.45), room_state(2.0, 1.45, "no wall")
    assert "apex 5; 6 hidden" in with_wall[2]["caption"] and "apex 6" in without[2]["caption"]
    with pytest.raises(InputError, match="wall"):
        room_state(wall="glass")
