"""Samples of grids of parameters: no value is left out that has room, and no case for good."""

from itertools import product

from sampled_cases import sample

GRID = [{("method", method), ("law", law)} for method, law in product("abcd", range(5))]


def test_each_value_comes_as_soon_as_there_is_room():
    for seed in range(50):
        chosen = sample(GRID, 5, str(seed))
        assert len(chosen) == 5
        assert set.union(*(GRID[number] for number in chosen)) == set.union(*GRID)


def test_other_sources_have_other_samples_and_the_same_have_the_same():
    assert sample(GRID, 3, "x") == sample(GRID, 3, "x")
    assert set.union(*(sample(GRID, 3, str(seed)) for seed in range(50))) == set(range(len(GRID)))


def test_small_grids_are_whole():
    assert sample(GRID, 99, "x") == set(range(len(GRID)))
    assert sample(GRID[:1], 1, "x") == {0}
