"""Records: codes of reasons have names."""

from __future__ import annotations

from unstruct.generate.prisms import records


def test_reasons_have_names() -> None:
    codes = (
        records.FULL,
        records.COLUMN,
        records.CROSSING_RAY,
        records.GRADATION,
        records.HIDDEN_RAY,
        records.STEP_RAY,
    )
    assert codes == tuple(range(len(records.RAY_REASONS)))
    assert [records.RAY_REASONS[c] for c in codes] == [
        "full", "column", "crossing", "gradation", "hidden", "step",
    ]  # fmt: skip
