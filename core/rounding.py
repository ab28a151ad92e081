"""What rounding means: every tolerance that tells a number from zero, in one place, with its reason.

Double precision carries 1.1e-16 of a number. None of the parts below is of 1 m, 1 N or 1 s: each is a part of what the
model itself is made of, so that a mechanism of a nanometre and one of a thousand kilometres are judged alike. Positions
are compared with coordinate_scale times `position_level`, rows of constraints and gaps with row_scale times that,
rates and accelerations likewise (`assembly/levels.py`), forces with `force_level` over row_scale; `assembly/scales.py`
says where these scales come from.
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
ROW_ROUNDING = 1e-15
"""Of the sum of the magnitudes that cancel in a row: a few roundings, which no correction takes away."""
CONTRADICTION = 1e-8
"""Of a row: a redundant row violated by more contradicts those that it repeats. Roots of what positions are solved to,
since redundant rows see the others' errors through their conditioning."""
ONLY_ROUNDING = 8.0 * 2.220446049250313e-16
"""Of a coordinate: an increment below it does not change the coordinate."""
CONTINUOUS = 1e-9
"""Of a row's rate: a larger change at a breakpoint is a jump of a driver's rate. What the constraints are met to is a
thousand times smaller."""
COMPATIBLE = 1e-12
"""Part of a force by which rows of compatibility that have not been renewed may be off."""
STILL_COMPATIBLE = 1e-13
"""Of a row: what null vectors may leave that are not found anew, ten times what solving for them leaves."""
RANK_TOLERANCE = 1e-9
"""Of a row: with less left of it after elimination it repeats others."""
EQUAL_PIVOTS = 1.0 - 1e-6
"""Of the largest pivot: others from there on are equal to it, and the lowest column is taken. What rounding makes of a
start, and of the elimination, is a millionth of the difference."""
NOT_DEPENDENT = 1e-9
"""Of a redundant row's norm: a row that contributes less to it is none of those that it repeats."""
START_RANK = 1e-6
"""Of a row: with less left of it after elimination a start is singular, if the row is not redundant. Rounding in the
accelerations is multiplied by its inverse cube."""
START_MOVED = 1e-12
"""Of a coordinate: a start that is moved by more to meet the constraints is worth telling."""

# ---- coordinates ----------------------------------------------------------------------------------------------------

COORDINATE_DIFFERENCES = 2e-13
"""Of a coordinate: what differences over several steps make of its rounding."""
COORDINATE_NOISE = 1e-14
"""Of a coordinate: its rounding after many steps."""
NO_STIFFNESS = 1e-12
"""Of a mass: what the difference of a diagonal with and without stiffness leaves of it."""

# ---- accelerations and multipliers ----------------------------------------------------------------------------------

ACCELERATIONS_SOLVED = 1e-14
"""Of the accelerations: refinement of their linear system stops here."""
ACCELERATIONS_LOST = 1e-8
"""Of the accelerations: where refinement leaves more, the system is singular to rounding."""
SENSITIVITY_SOLVED = 1e-9
"""Of the terms: a residual of the linear equations for derivatives that is larger means that they have no solution."""
FINEST = 1e-13
"""Of the increments: an outer loop with less left is done. A formula does not ask for less by itself."""
PIVOT_NOISE = 1e-14
"""Of a term of its own sum: a pivot that is smaller holds nothing but rounding."""

# ---- contacts -------------------------------------------------------------------------------------------------------

GAP_ROUNDING = 3e-13
"""Of a gap's size: shapes nearer than this touch; three times what the constraints are met to."""
GAP_MOVES = 1e-2
"""Of GAP_ROUNDING: a gap of shapes that touch which changes by less within a step does not change."""
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
PRESSING = 1e-6
"""Of the accelerations: with more, the gap of shapes that touch begins to close. The forces of many contacts leave less
of it."""
IMPLIED_MOVES = 1e-10
"""Of the level of positions: a closed gap that others imply, and that has moved by more, they do not imply."""
IMPLIED_TURNS = 0.03
"""Of the level of accelerations, the same."""
IMPLIED_SLIDES = 1e-10
"""Of the level of velocities: what sticks since others imply it, and slides by more, they do not hold."""
SLIP_EXCESS = 1e-9
"""Of its limit: friction that is beyond it by no more has not passed it. Blocks that ride on one another need exactly
the limit all along, and rounding must not let them slip."""
TURNS = 1e-6
"""The same where friction at its limit turns: from here on its direction is taken anew."""
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
BRAKED = 1e-9
"""Of the largest acceleration: what slides with no speed and is braked by less begins to slide, it does not stop."""
REACHES_LIMIT = 1e-9
"""Of the limit: friction that is nearer to it has reached it."""
NO_JERK = 1e-9
"""Of its terms: a rate of a gap's acceleration below this is none."""
ENERGY_GAIN = 1e-12
"""Of the kinetic energy: an impact that gains more is one to report."""
SAME_PLACE = 1e-12
"""Of a line's coordinates, a body's size: points that are nearer are one, as cos(2 pi) and cos(0)."""
SAME_PARAMETER = 1e-16
"""Of a curve's parameter, which goes from 0 to 1: Newton's method for a foot changes it no more."""

# ---- several contacts -----------------------------------------------------------------------------------------------

IMMOVABLE = 1e-12
"""Of what it could be: a direction with a smaller inverse effective mass cannot move."""
DIRECTION_RANK = 1e-10
"""Of a direction's inverse mass: with less left of it beside the others, it repeats them."""
STICKING_RANK = 1e-10
"""Of the largest singular value of the friction of contacts that stick: a smaller one is zero."""
CONDITIONS_RANK = 1e-13
"""Of the largest singular value of the active conditions: a smaller one is zero."""
TOGETHER = 1e-9
"""Of the largest motion: contacts that move less stay together."""
NO_FORCE = 1e-12
"""Of the largest force: a smaller one is none."""
STICKING_MOVES = 1e-9
"""Of the motion that friction is to take away: with more left of it, contacts do not all stick."""
BEYOND_LIMIT, NO_FRICTION = 1e-12, 1e-14
"""Parts of a limit and of the largest friction by which friction may be beyond its limit."""
REACHES_LIMIT_NOW = 1e-6
"""Of the limit, in space: friction of a contact whose event is that it reaches it is that near at least."""
STICKS_STILL = 1e-9
"""Of the largest acceleration, in space: what sticks moves less along its tangents."""
LOADS_SETTLED = 1e-13
"""Of the load of a joint's friction that follows the force of the joint."""
NEARLY_JAMMED = 1e-6
"""Of a contact's inverse effective mass: with less left of it by friction, it jams."""
FRICTION_ENOUGH = 1e-14
"""Of the largest force of several contacts in space: what a sweep changes when it is done."""
FRICTION_SOLVED = 1e-15
"""The same: where Newton's method leaves no more, its next step would be made of rounding."""
FRICTION_NEAR = 1e-12
"""The same: what Newton's method may leave."""
FRICTION_EXACT = 1e-10
"""Of the largest force: what extrapolated forces may leave."""
FRICTION_GOOD = 1e-8
"""The same: contacts that nearly repeat each other leave what they differ by."""
FRICTION_ROUGH = 1e-5
"""The same: what sweeps may change that come to no end. Friction is in its cones then, and what still approaches is
struck again."""
FRICTION_MOTION = 1e-6
"""Of the largest motion without forces: what may be left of it where forces have been found. Forces that grow without
bound, because there are none, change little against themselves."""
FRICTION_FOLLOWED = 1e-11
"""Of the largest force: what is left at each point of a path of forces."""
FRICTION_RANK = 1e-13
"""Of the largest singular value in that Newton's method: a smaller one is zero."""
STILL = 1e-9
"""Of the speed that weight gives over the mechanism's size: there the direction of sliding goes on through zero."""
LCP_PIVOT = 1e-11
"""Of the column's largest: a smaller entry is rounding, and no pivot."""
LCP_TIES = (1e-13, 1e-11, 1e-9)
"""Relative: right-hand sides and ratios that are nearer are equal. Where rounding leads pivoting astray with the first,
the next is tried."""
LCP_VIOLATION = 1e-9
"""Of the conditions, relative: beyond it a result is none."""
LCP_RANK = 1e-13
"""Of the largest singular value of the solution's equations: a smaller one is zero."""
SWEEP_ROUNDING = 1e-14
"""Of its terms: a determinant or a condition of one contact's problem that is smaller is zero."""
CONES_CONVERGED = 1e-12
"""Of the largest motion: what is left of the conditions is rounding."""
CONES_NEAR = 1e-7
"""Of the largest motion: the same where a step along the path has failed if more is left."""
CONES_GOOD = 1e-7
"""Of the largest motion: with more left at the end, there is no solution. Where contacts repeat each other nearly, a
motion of this size would take forces beyond all measure to undo."""

# ---- time -----------------------------------------------------------------------------------------------------------

NO_STEP = 4e-16
"""Of the time: what is left before a stop or a breakpoint is rounding, and no step is made of it."""
SHORTEST = 1e-13
"""Of the time, or of a millionth of the model's time: steps are not made smaller than this when they fail."""
RESOLVED_TIME = 2e-16
"""Of the time within a step: a search for an event ends at an interval of this length."""
SAME_TRIAL = 1e-15
"""Of a step: a trial that is nearer to the last one gives nothing new."""
SAME_INSTANT = 1e-12
"""Of a step: events nearer than this are at one instant."""
AS_LONG = 1e-9
"""Of the longest step: one that is longer by no more is the longest."""
SAME_INPUT = 1e-14
"""Relative: an input with derivatives that changes by less goes on as it did. What a caller computes along a straight
line comes with rounding; inputs without derivatives are compared bit by bit."""
PUNCTUAL = 1e-9
"""Of the interval between two changes of inputs: what a caller's grid may be off by."""

# ---- what a model is given ------------------------------------------------------------------------------------------

AT_ORIGIN = 1e-9
"""Of the longest part: points that are no farther from the origin say nothing of the mechanism's size. A body on a
circle about the origin is not at 0 but for the rounding of a cosine."""
SYMMETRY = 1e-12
"""Of the largest entry: by so much entries of a symmetric matrix may differ from their mirror images."""
DEFINITE = 1e-12
"""Of the mass matrix, scaled to a unit diagonal: an eigenvalue below this is none of a definite matrix."""
AGREEMENT = 1e-8
"""Of the largest entry: derivatives that are given may differ by this from those that are formed by differences."""
CANCELLED = 1e-12
"""Of the terms that cancel in the right-hand side of the acceleration level: what rounding leaves."""
TRIANGLE = 1e-9
"""Of the largest principal moment of inertia: by so much it may exceed the sum of the others, as a file's digits do."""
NEARLY_PARALLEL = 1e-9
"""Sine of an angle: directions with a smaller one between them span no plane."""
MEETING = 1e-12
"""Of the mechanism's size: between markers that are nearer there is no direction but rounding."""
ON_NODE = 1e-9
"""Of a length: a place that is nearer to a node than this is the node."""
BEYOND_END = 1e-12
"""Of a length: a place beyond the end by no more is the end."""

# ---- values that cannot be ------------------------------------------------------------------------------------------

LARGEST = 1e100
"""In any unit: beyond it squares overflow, and energies with them."""
