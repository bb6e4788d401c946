"""The layers of pattern files are those of ASTM D6673-10."""

from stages.model.patternlayers import NOTCH_LAYERS, STANDARD


def test_the_layers_are_1_to_15_and_80_to_87() -> None:
    assert sorted(map(int, STANDARD)) == [*range(1, 16), *range(80, 88)]
    assert set(NOTCH_LAYERS.values()) <= STANDARD
