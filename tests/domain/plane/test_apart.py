"""The quick proof that chords are safe never claims more than the whole test finds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from unstruct import Arc, Bezier, Domain
from unstruct.domain.plane import sample
from unstruct.domain.plane.apart import surely_apart
from unstruct.geometry.outline import Outline
from unstruct.geometry.segment_pairs import meetings, vertices_on_segments

GRID = st.integers(0, 5)
PLACES = st.tuples(GRID, GRID)


@st.composite
def outlines(draw: st.DrawFn) -> tuple[Outline, int]:
    """Chains of straight and bent pieces, with a loose vertex and a seed; parts of each piece."""
    places = draw(st.lists(PLACES, min_size=4, max_size=7, unique=True))
    scale = 2.0 ** draw(st.sampled_from([-200, 0, 0, 0, 40]))
    points = np.array(places, dtype=float) * scale + draw(st.sampled_from([0.0, 0.0, 0.1])) * scale
    many = len(points) - 1  # the last vertex is loose
    ends = np.column_stack([np.arange(many), (np.arange(many) + 1) % many]).astype(np.int32)
    curves = {}
    for piece in range(many):
        if draw(st.booleans()):
            a, b = points[ends[piece]]
            bend = np.array(draw(PLACES), dtype=float) * scale
            flat = draw(st.sampled_from([1.0, 1.0, 1e-6, 1e-13]))
            curves[piece] = Bezier([a, (a + b) / 2 + flat * (bend - (a + b) / 2), b])
    seed = np.array([draw(PLACES)], dtype=float) * scale
    outline = Outline(points, ends, ends[:0], curves, {}, {"seed": seed})
    assume(straight_pieces_are_sound(outline))  # as they are when domains are cut
    return outline, draw(st.integers(1, 6))


def straight_pieces_are_sound(outline: Outline) -> bool:
    """Whether no two whole straight pieces meet but at common ends, and none holds a vertex or the seed."""
    straight = np.delete(outline.pieces, list(outline.curves), axis=0)
    points = np.concatenate([outline.points, *outline.regions.values()])
    if len(meetings(points, straight)[0]):
        return False
    return not len(vertices_on_segments(points, np.arange(len(points)), straight))


def both(outline: Outline, parts: int, monkeypatch: pytest.MonkeyPatch) -> tuple[bool, int]:
    """What the proof says, and how many conflicts there are."""
    many = len(outline.pieces)
    piece, t = np.repeat(np.arange(many), parts), np.tile(np.arange(parts) / parts, many)
    sampled = sample.assemble(outline, piece, t, np.tile(np.arange(1, parts + 1) / parts, many))
    rows = np.flatnonzero(np.isin(piece, list(outline.curves)))
    chains = sample.fine_chains(outline, sampled, rows)
    sure = surely_apart(outline, sampled.points, sampled.ends, rows, chains)
    with monkeypatch.context() as m:
        m.setattr(sample, "surely_apart", lambda *_: False)
        return sure, len(sample.conflicts(outline, sampled, rows, chains))


@given(outlines())
@settings(max_examples=300, deadline=None)
def test_what_is_surely_apart_is_in_no_conflict(given_: tuple[Outline, int]) -> None:
    with pytest.MonkeyPatch.context() as m:
        sure, many = both(*given_, m)
    assert not (sure and many)


@pytest.mark.parametrize("parts", [16, 64])
def test_usual_regions_are_proved(parts: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A disc and an airfoil with its sharp edge; loose vertices and seeds away from them cost nothing."""
    wing = Domain.naca("2412", attack=4.0)
    disc = Domain.disc((0.0, 0.0), 6.0, regions={"fluid": [(0.0, -1.0)]})
    for outline in (wing, disc, disc.with_holes(wing)):
        assert both(outline, parts, monkeypatch) == (True, 0)


@pytest.mark.parametrize("height", [1e-3, 1e-9, 0.0])
def test_a_loose_vertex_beside_a_chord_is_left_to_the_whole_test(
    height: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    points = np.array([(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0 - height)])
    facets = np.array([(1, 0), (0, 1)], dtype=np.int32)
    outline = Outline(points, facets, facets[:0], {1: Arc((0, 0), 1.0, 0.0, np.pi)}, {}, {})
    sure, many = both(outline, 2, monkeypatch)
    assert not sure or not many
    assert both(outline, 64, monkeypatch)[0] == (height > 1e-3 / 2)
