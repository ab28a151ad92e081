"""The claims of the method's papers about iterations and orders, and what the figures of a study say about them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ...core import simulate
from .cases import Setting
from .equal_error import LEVELS, at_error
from .orders import OrderRow
from .runs import LOOPS, Run
from .swing import Swing

ORDERED = ("newmark", "hht", "bdf", "ebdf")
"""Methods whose order rows the claims need."""
HHT, EBDF = Setting("hht"), Setting("ebdf", {"k": 4})
"""What C3 compares, as in `CONTENDERS`."""
BESIDE = Setting("ebdf", {"k": "auto"})
"""Compared with HHT as well, without a say in the verdict."""
WITHIN = 0.2
"""How far an observed order may lie above a bound."""
BASES = ("tolerance", "error")


@dataclass(frozen=True)
class Claim:
    """A claim and what was found."""

    name: str
    claim: str
    verdict: str
    """"holds", "holds in part" or "does not hold"."""
    observed: tuple[str, ...]
    """Sentences with figures."""
    figures: dict[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "name": self.name, "claim": self.claim, "verdict": self.verdict, "observed": list(self.observed),
            "figures": self.figures,
        }  # fmt: skip


def judge(runs: Sequence[Run], orders: Sequence[OrderRow]) -> tuple[Claim, ...]:
    """Those of C1, C2 and C3 that the runs of a study and the order rows of `ORDERED` can decide."""
    measured = {row.case.setting.method for row in orders}
    claims = []
    if measured & {"newmark", "hht"}:
        claims.append(first_claim(orders))
    if measured & {"bdf", "ebdf"}:
        claims.append(second_claim(orders))
    if {HHT, EBDF} <= {run.setting for run in runs}:
        claims.append(third_claim(runs))
    return tuple(claims)


def first_claim(orders: Sequence[OrderRow]) -> Claim:
    """C1: unknowns and order of TLISMNI(Newmark/HHT)."""
    found = {row.case.setting.label: row.orders for row in orders if row.case.setting.method in ("newmark", "hht")}
    least, highest = min(min(values) for values in found.values()), max(max(values) for values in found.values())
    stages = _stages(HHT)
    return Claim(
        "C1",
        "TLISMNI(Newmark/HHT) has accelerations and multipliers as unknowns and order 2 at most",
        "holds" if highest <= 2.0 + WITHIN else "does not hold",
        (
            f"observed orders of positions, velocities and multipliers of {len(found)} formulas: {least:.2f} ... "
            f"{highest:.2f}",
            f"{stages:.0f} stage a step, with independent accelerations and multipliers as unknowns",
        ),
        {"orders": found, "highest": highest, "stages_per_step": stages},
    )


def second_claim(orders: Sequence[OrderRow]) -> Claim:
    """C2: order and loop structure of TLISMNI(BDF/EBDF)."""
    found = {row.case.setting.label: row.orders for row in orders if row.case.setting.method in ("bdf", "ebdf")}
    above = {label: values for label, values in found.items() if min(values) > 2.0 + WITHIN}
    stages = {setting.label: _stages(setting) for setting in (HHT, EBDF, Setting("bdf", {"order": 3}))}
    highest = max(found, key=lambda label: min(found[label]))
    different = stages[EBDF.label] != stages[HHT.label]
    return Claim(
        "C2",
        "TLISMNI(BDF/EBDF) has coordinates and velocities as unknowns, a higher order, and another loop structure",
        "holds in part" if above else "does not hold",
        (
            f"{len(above)} of {len(found)} formulas are above order 2; the highest is {highest} with "
            + ", ".join(f"{x:.2f}" for x in found[highest]),
            "stages a step: " + ", ".join(f"{label} {count:.0f}" for label, count in stages.items()),
            "the choice of unknowns makes no difference here: v = P + h b a and q = P + h b v turn coordinates and "
            "velocities into the same stage, affine in the accelerations, that Newmark and HHT have; "
            + ("only the number of stages differs" if different else "nor does the number of stages differ"),
        ),
        {"orders": found, "above_two": sorted(above), "stages_per_step": stages},
    )


def third_claim(runs: Sequence[Run]) -> Claim:
    """C3: outer iterations of HHT over those of EBDF, at equal tolerance and at equal achieved error."""
    ratios = ratio_table(runs)
    shares, observed = [], []
    for setting in (EBDF, BESIDE):
        for loop in LOOPS:
            for basis in BASES:
                wanted = (setting.label, loop, basis)
                rows = [row for row in ratios if (row["label"], row["outer"], row["basis"]) == wanted]
                if not rows:
                    continue
                fewer = sum(row["ratio"] > 1.0 for row in rows)
                if setting == EBDF:
                    shares.append(fewer / len(rows))
                least, most = min(row["ratio"] for row in rows), max(row["ratio"] for row in rows)
                observed.append(
                    f"{setting.label}, {loop} loop, equal {basis}: fewer iterations than hht in {fewer} of {len(rows)} "
                    f"cases, hht/ebdf = {least:.2g} ... {most:.2g}{_where(rows)}"
                )
    verdict = "holds" if all(share == 1.0 for share in shares) else "holds in part"
    if all(share == 0.0 for share in shares):
        verdict = "does not hold"
    return Claim(
        "C3",
        "TLISMNI(EBDF) needs fewer iterations than TLISMNI(HHT) for the same error tolerance",
        verdict,
        (*observed, *_achieved(runs)),
        {"ratios": ratios},
    )


def ratio_table(runs: Sequence[Run]) -> list[dict[str, Any]]:
    """Outer iterations of HHT over those of EBDF: one row an EBDF, problem, outer loop, basis and level."""
    table = []
    for setting in (EBDF, BESIDE):
        for problem in dict.fromkeys(run.problem for run in runs):
            for loop in LOOPS:
                of_hht, of_ebdf = (
                    {r.tolerance: r for r in runs if (r.problem, r.setting, r.loop) == (problem, s, loop) and r.ok}
                    for s in (HHT, setting)
                )
                pairs: list[tuple[str, float, float | None, float | None]] = [
                    ("tolerance", level, float(run.outer_iterations), float(of_ebdf[level].outer_iterations))
                    for level, run in of_hht.items()
                    if level in of_ebdf
                ]
                a, b = list(of_hht.values()), list(of_ebdf.values())
                pairs += [("error", level, at_error(a, level), at_error(b, level)) for level in LEVELS]
                table += [
                    {
                        "label": setting.label, "problem": problem, "outer": loop, "basis": basis, "level": level,
                        "hht": needs_hht, "ebdf": needs_ebdf, "ratio": needs_hht / needs_ebdf,
                    }
                    for basis, level, needs_hht, needs_ebdf in pairs
                    if needs_hht is not None and needs_ebdf is not None
                ]  # fmt: skip
    return table


def _achieved(runs: Sequence[Run]) -> tuple[str, ...]:
    """How far the achieved errors of the pair are apart at equal tolerance."""
    errors = {(r.problem, r.loop, r.tolerance): r.error for r in runs if r.setting == EBDF and r.ok}
    ratios = [
        r.error / errors[key]
        for r in runs
        if r.setting == HHT and r.ok and (key := (r.problem, r.loop, r.tolerance)) in errors
    ]
    if not ratios:
        return ()
    return (
        f"equal tolerance is not equal error: the error that hht achieves is {min(ratios):.2g} ... {max(ratios):.2g} "
        f"times that of {EBDF.label}",
    )


def _where(rows: Sequence[dict[str, Any]]) -> str:
    """From which level down the claim holds in every case, if from one."""
    levels = sorted({row["level"] for row in rows}, reverse=True)
    holds = {level: all(row["ratio"] > 1.0 for row in rows if row["level"] == level) for level in levels}
    for k, level in enumerate(levels):
        if all(holds[x] for x in levels[k:]):
            return f"; in every case from {level:.0e} down" if k else ""
    return ""


def _stages(setting: Setting) -> float:
    """Stages of a fixed step: from two runs that start alike, so that the start does not count."""
    swing, h = Swing(), 0.01
    stats = [
        simulate(swing.model(), t_end, setting.method, step=h, record=False, **setting.options).stats
        for t_end in (0.5, 1.0)
    ]
    return (stats[1]["stages"] - stats[0]["stages"]) / (stats[1]["steps"] - stats[0]["steps"])
