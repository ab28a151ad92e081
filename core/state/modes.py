"""Contact modes and the layout of a contact's memory (one row of floats for each contact, part of the state)."""

OPEN = 0.0
CLOSED = 1.0  # CCM: the gap is a constraint
ACTIVE = 2.0  # CCFM: the force law acts
RELEASED = 3.0  # CCFM: the force has reached zero while the shapes still overlap
UNWATCHED = -1.0  # CCM, within a step of impulses: open, and nobody looks for its events

MODE_NAMES: dict[float, str] = {OPEN: "open", CLOSED: "closed", ACTIVE: "active", RELEASED: "released"}

# when a contact that acts as a force ends (`contact_release`)
NO_FORCE_LAW = 0  # it is a constraint contact
AT_ZERO_GAP = 1
AT_ZERO_FORCE = 2
AT_ZERO_GAP_OR_FORCE = 3  # the latter where others draw the shapes apart faster than they rebound from each other

# how a closed contact with friction moves along its tangent; +1 and -1: it slides in that direction
STICKS = 0.0  # its sliding distance is a constraint
IDLE = 2.0  # it cannot slide because others hold it, and carries a share of its normal force (RATIO)
AT_LIMIT = 3.0  # in space: others hold it, with its friction RATIO F_N along the second tangent at its limit; along the
# first one, across that friction, its sliding is zero, and that row's multiplier turns the direction a little

# columns of the memory
MODE = 0
APPROACH_SPEED = 1  # at the last first touch, m/s
LARGEST_APPROACH = 2  # since the start, m/s
IMPULSE_JUMP = 3  # sum of impact impulses, N s
LOSS_JUMP = 4  # sum of energy lost at impacts and releases, J
SLIDE = 5  # STICKS, IDLE, AT_LIMIT, +1 or -1 (in space +1: along WAY)
SLIDE_START = 6  # sliding distance at which the contact began to stick, m
RATIO = 7  # F_T/F_N of a closed contact that does not stick: +-mu while it slides
GAP_START = 8  # gap at which a contact constraint holds, next to nothing, m
BEGUN_IMPULSE = 9  # impulse of a contact force when it began to act, N s
BEGUN_LOSS = 10  # its dissipation then, J
PUSHED = 11  # of a constraint contact in the last step of impulses: mean normal force, N
PUSHES = 6  # columns: it, along two tangents, and torques against rolling about two axes and spinning, N m
IMPLIED = PUSHED + PUSHES  # of a closed contact, which of its rows are implied by others: a sum of the following
OF_NORMAL, OF_FIRST, OF_SECOND = 1, 2, 4
MEMORY_SIZE = IMPLIED + 1
# of force contacts, in a column that these have no other use for:
LAID_MASS = GAP_START  # effective mass of shapes that met without an approach, kg; else 0
# of constraint contacts with friction in space, in columns that these have no other use for (`contacts/frame3d.py`):
WAY = SLIDE_START  # angle of the first tangent, rad
AXIS = BEGUN_IMPULSE  # which axis of the first marker angles are counted from: 1, 2, 3; 0: not chosen
LEAN = APPROACH_SPEED  # angle of the direction of sliding and spinning out of the tangent plane, rad
SLOW = BEGUN_LOSS  # sliding speed whose direction error control does not resolve, m/s
