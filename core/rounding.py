"""What rounding means: every tolerance that tells a number from zero, in one place, with its reason.

Double precision carries 1.1e-16 of a number. None of the parts below is of 1 m, 1 N or 1 s: each is a part of what the
model itself is made of, so that a mechanism of a nanometre and one of a thousand kilometres are judged alike. Positions
are compared with coordinate_scale times `position_level`, rows of constraints and gaps with row_scale times that,
rates and accelerations likewise (`tables/levels.py`), forces with `force_level` over row_scale; `tables/scales.py` says
where these scales come from.
"""

# ---- constraints ----------------------------------------------------------------------------------------------------

CONSTRAINT_TOLERANCES = (1e-13, 1e-14, 1e-13)
"""Of a row at position, velocity and acceleration level: a thousand roundings, what some terms with lever arms of ten
times the mechanism's size still meet. Velocities are solved for once the positions are met: they come out finer."""
ANGLES = 0.1
"""What an angle counts in the level of the coordinates: most turn arms much shorter than the mechanism, and where they
do not, there are translations that go as far. A tenth of CONSTRAINT_TOLERANCES is still above what rounding leaves."""
CONSTRAINT_NOISE = 2e-15
"""Of a row: what rounding leaves in a constraint of what the terms hold, divided by the least singular value of Phi_q
across the motion near a singular position."""
EXACTLY_MET = 1e-16
"""Of a row: below half a rounding nothing is left to correct."""
MET = 1e-15
"""Of a row: a Newton correction at rare work stops here, a few roundings."""
NEARLY_MET = 1e-11
"""Of a row: where corrections no longer halve what is left, this much of it is rounding."""
CONTRADICTION = 1e-8
"""Of a row: a redundant row violated by more contradicts those that it repeats. Roots of what positions are solved to,
since redundant rows see the others' errors through their conditioning."""
ONLY_ROUNDING = 8.0 * 2.220446049250313e-16
"""Of a coordinate: an increment below it does not change the coordinate."""
CONTINUOUS = 1e-9
"""Of a row's rate: a larger change at a breakpoint is a jump of a driver's rate. What the constraints are met to is a
thousand times smaller."""

# ---- coordinates ----------------------------------------------------------------------------------------------------

COORDINATE_DIFFERENCES = 2e-13
"""Of a coordinate: what differences over several steps make of its rounding."""
COORDINATE_NOISE = 1e-14
"""Of a coordinate: its rounding after many steps."""

# ---- accelerations and multipliers ----------------------------------------------------------------------------------

ACCELERATIONS_SOLVED = 1e-14
"""Of the accelerations: refinement of their linear system stops here."""
ACCELERATIONS_LOST = 1e-8
"""Of the accelerations: where refinement leaves more, the system is singular to rounding."""

# ---- contacts -------------------------------------------------------------------------------------------------------

GAP_ROUNDING = 3e-13
"""Of a gap's size: shapes nearer than this touch; three times what the constraints are met to."""
UNRESOLVED = 1e-12
"""Of a gap's size: bounces lower than this are not told from rest."""
START_OVERLAP = 1e-9
"""Of a gap's size: an overlap or a gap at the start below this is a slip of rounding in a model's file."""
RATE_ROUNDING = 1e-12
"""Of the speeds: a gap that moves more slowly than this is at rest."""
PERHAPS_REST = 1e-3
"""Of the speeds: gaps that open faster than this are certainly not at rest."""
FORCE_ROUNDING = 1e-12
"""Of the forces: a contact force below this is none."""
NEAR_ZERO = 1e-6
"""Of the forces: one that an event has left with less may be zero."""
NO_ACCELERATION = 1e-11
"""Of what weights and forces make: a gap's acceleration below this is none."""
NO_SLIDING = 2e-13
"""Of its terms: an acceleration along the tangent below this is none."""
PRESSING = 1e-6
"""Of the accelerations: with more, the gap of shapes that touch begins to close. The forces of many contacts leave less
of it."""
SLIP_EXCESS = 1e-9
"""Of its limit: friction that is beyond it by no more has not passed it. Blocks that ride on one another need exactly
the limit all along, and rounding must not let them slip."""
UNSOLVED = 1e-7
"""Of the fastest motion: rounds of impacts that leave less, and no less than those before, are at their end."""
FIRST_TOUCH = 1e-8
"""Of a gap's size: by so much the first step of a force contact closes it, so that the error control sees the force
grow."""
LEAST_DEFLECTION = 1e-8
"""Of the mechanism's size: bristles that would slip at less slip and rub in proportion to the normal force."""
LEAST_APPROACH = 1e-6
"""Of the model's speeds: laws that divide by the approach speed divide at least by this, unless told otherwise."""
FIRST_PENETRATION = 1e-12
"""Of a gap's size: where the search for a static penetration begins."""
DEEPEST = 1e12
"""Of a gap's size: a penetration at which every spring that holds anything does."""

# ---- time -----------------------------------------------------------------------------------------------------------

NO_STEP = 4e-16
"""Of the time: what is left before a stop or a breakpoint is rounding, and no step is made of it."""
SHORTEST = 1e-13
"""Of the time, or of a millionth of the model's time: steps are not made smaller than this when they fail."""

# ---- values that cannot be ------------------------------------------------------------------------------------------

LARGEST = 1e100
"""In any unit: beyond it squares overflow, and energies with them."""
