"""The classical front in space as frames: what captions and numbers say is what the plain front did."""

from __future__ import annotations

from unstruct import examples
from unstruct.generate.space_front.classical_run import body_faces
from unstruct.plain import advancing_front_space as plain
from unstruct.view import check_frame
from unstruct.view.scenes.space_fronts import front_items3, space_front_frames

SEVEN = [(1, 3, 0), (1, 3, 3), (1, 3, 5), (4, 0, 5), (4, 1, 2), (5, 0, 4), (5, 3, 5)]
TEN_FACES = [
    (3, 2, 6), (6, 2, 1), (1, 2, 3), (0, 3, 4), (1, 3, 0), (6, 1, 0), (6, 0, 4), (5, 3, 6), (4, 3, 5),
    (5, 6, 4),
]  # fmt: skip


def test_a_body_of_seven_points() -> None:
    steps = list(plain.advancing_front_in_space(SEVEN, TEN_FACES, lambda x: 3.0, key=plain.by_age))
    frames = space_front_frames(SEVEN, TEN_FACES, steps)
    for one in frames:
        check_frame(one)
    assert len(frames) == len(steps) + 1
    assert frames[0]["caption"] == "face 2 6 3: X is taken"
    assert frames[2]["caption"].endswith("2 contains; 6 is taken") and "X too near" in frames[2]["caption"]
    assert [int(one["number"].split()[2]) for one in frames] == [10, *(len(s.front) for s in steps)]
    roles = [{item["role"] for item in one["items"]} for one in frames]
    assert all({"front", "highlight", "inserted"} <= some for some in roles[:-1])
    assert ["circumcircle" in some for some in roles] == [s.radius > 0 for s in steps] + [False]
    assert ["bad" in some for some in roles[:-1]] == [any(c.verdict for c in s.candidates) for s in steps]
    assert roles[-1] == {"accepted", "vertex"} and frames[-1]["caption"] == "the front is empty"


def test_a_front_that_sticks() -> None:
    domain = examples.stuck_body("convex")
    points, faces = domain.points.tolist(), body_faces(domain).faces.tolist()
    steps = list(plain.advancing_front_in_space(points, faces, lambda x: 2.0))
    frames = space_front_frames(points, faces, steps)
    assert frames[-1]["caption"] == "the front is stuck, with 8 faces"
    assert "front" in {item["role"] for item in frames[-1]["items"]} and len(frames) == 5
    nothing = space_front_frames(points, faces, [])
    assert nothing[0]["number"] == "0 cells, 12 faces of the front"


def test_items_of_a_front() -> None:
    items = front_items3(SEVEN, TEN_FACES)
    assert [len(item["data"]) for item in items] == [10, 15, 7]
    assert len(front_items3(SEVEN, TEN_FACES, names=False)) == len(front_items3(SEVEN, [])) == 2
