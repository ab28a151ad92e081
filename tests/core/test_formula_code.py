"""Kept code of formulas: its key holds all that a formula can reach, and is the same in every process."""

import subprocess
import sys
import textwrap

import pytest
from tlismni.core.compiled.formula_code import FormulaCode

HELPER = "FACTOR = 3.0\n\ndef doubled(x):\n    return 2.0 * x\n"
MODULE = """
    import math
    import some_helper
    from some_helper import FACTOR, doubled

    TABLE = [1.0]
    NAMES = frozenset(["a", "b", "c", "d"])

    def formula(a, b):
        return FACTOR * doubled(b.x) + math.sin(a.x)

    def by_module(a, b):
        return some_helper.doubled(b.x)

    def with_list(a, b):
        return TABLE[0] * b.x

    def with_set(a, b):
        return b.x if "a" in {"a", "b", "c", "d"} else a.x
"""


def contents(folder, module=MODULE, helper=HELPER, seed="1"):
    """What the keys say of the formulas in `module`, in a process of its own."""
    (folder / "some_formulas.py").write_text(textwrap.dedent(module))
    (folder / "some_helper.py").write_text(helper)
    script = """
import sys
sys.path.insert(0, sys.argv[1])
import some_formulas
from tlismni.core.compiled.formula_code import FormulaCode
for name in ("formula", "by_module", "with_list", "with_set"):
    function = getattr(some_formulas, name)
    code = FormulaCode(function, (function,))
    print(code._content, code.cache_path is not None, sep="|")
"""
    done = subprocess.run(
        [sys.executable, "-B", "-c", script, str(folder)], capture_output=True, text=True, check=True,
        env={"PYTHONHASHSEED": seed, "HOME": str(folder), "PATH": ""},
    )  # fmt: skip
    return [line.split("|") for line in done.stdout.splitlines()]


@pytest.fixture(scope="module")
def before(tmp_path_factory):
    """What the keys say of the modules as they stand above."""
    return contents(tmp_path_factory.mktemp("formulas"))


def test_keys_are_equal_in_all_processes(tmp_path, before):
    assert contents(tmp_path, seed="2") == before


@pytest.mark.parametrize("change", [("2.0", "2.5"), ("FACTOR = 3.0", "FACTOR = 4.0")])
def test_what_a_formula_reaches_in_other_files_changes_its_key(tmp_path, before, change):
    after = contents(tmp_path, helper=HELPER.replace(*change))
    assert [x != y for x, y in zip(before, after, strict=True)] == [True, True, False, False]


def test_a_module_s_function_is_followed_to_what_it_calls(tmp_path):
    helper = (
        "import some_base\nfrom some_base import halved\nFACTOR = 3.0\ndef doubled(x):\n    return 4.0 * halved(x)\n"
    )
    found = []
    for factor in ("0.5", "0.6"):
        (tmp_path / "some_base.py").write_text(f"def halved(x):\n    return {factor} * x\n")
        found.append(contents(tmp_path, helper=helper))
    assert [x != y for x, y in zip(*found, strict=True)] == [True, True, False, False]


def test_its_own_file_changes_the_key(tmp_path, before):
    after = contents(tmp_path, MODULE.replace("math.sin", "math.cos"))
    assert before[0] != after[0]


def test_what_cannot_be_compared_is_not_kept(tmp_path):
    found = contents(tmp_path)
    assert [kept for _, kept in found] == ["True", "True", "False", "True"]
    number = [1.0]

    def closed(a, b):
        return number[0] * b.x

    assert FormulaCode(closed, (closed,)).cache_path is None


def test_layout_and_companions_belong_to_the_key():
    def one(a, b):
        return b.x

    def other(a, b):
        return b.y

    keys = {
        FormulaCode(one, formulas, layout)._content
        for formulas in ((one,), (other,), (one, other))
        for layout in ("ab", "ba")
    }
    assert len(keys) == 6
