"""C4: what the runs of the contact study say about the claim."""

from collections.abc import Sequence

from .claims import Claim
from .contact_failure import ContactRow

TLISMNI = ("ebdf", "hht")
NAMED = ("baumgarte", "hht_ggl")
"""The methods that the claim names."""
CLAIM = (
    "In some contact-and-constraint cases Baumgarte and HHT-alpha (on GGL) cannot give reasonable results while "
    "TLISMNI does"
)


def fourth_claim(rows: Sequence[ContactRow]) -> Claim:
    """C4 as the runs have it: a run is reasonable if it has none of `ContactRow.faults`."""
    named, others = NAMED, sorted({row.setting.method for row in rows} - {*NAMED, *TLISMNI})
    observed = [_sentence(rows, True, TLISMNI, "TLISMNI"), _sentence(rows, True, named, "Baumgarte and HHT on GGL")]
    observed += [_sentence(rows, True, (name,), name) for name in others]
    observed += [
        _sentence(rows, False, TLISMNI, "TLISMNI"),
        _sentence(rows, False, (*named, *others), "all others"),
    ]
    right = not _faulty(rows, True, TLISMNI)
    failing = {row.setting.method for row in rows if row.jump and row.faults} - set(TLISMNI)
    without = not _right(rows, False)
    if without:
        observed.append(
            "without the velocity jump no method gives a reasonable result in any problem: what fails is the missing "
            "impact law, and finer steps do not mend it"
        )
    verdict = "holds" if right and set(named) <= failing else "holds in part" if right and failing else "does not hold"
    return Claim(
        "C4",
        CLAIM,
        verdict,
        tuple(observed),
        {"fails_with_jump": sorted(failing), "right_without_jump": [row.to_dict() for row in _right(rows, False)]},
    )


def _right(rows: Sequence[ContactRow], jump: bool) -> list[ContactRow]:
    return [row for row in rows if row.jump is jump and not row.faults]


def _faulty(rows: Sequence[ContactRow], jump: bool, methods: Sequence[str]) -> list[ContactRow]:
    return [row for row in rows if row.jump is jump and row.setting.method in methods and row.faults]


def _sentence(rows: Sequence[ContactRow], jump: bool, methods: Sequence[str], name: str) -> str:
    runs = [row for row in rows if row.jump is jump and row.setting.method in methods]
    bad = _faulty(rows, jump, methods)
    how = "with" if jump else "without"
    text = f"{how} the velocity jump, {name}: {len(runs) - len(bad)} of {len(runs)} runs are reasonable"
    if not bad or not jump:
        return text
    which = sorted({
        f"{row.setting.label}, {'error-controlled' if row.step is None else f'step {row.step:g} s'}: "
        f"{' and '.join(row.faults)}"
        for row in bad
    })  # fmt: skip
    return f"{text}; not {'; '.join(which)}"
