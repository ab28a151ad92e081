/* Codes that compiled code returns, records of its arrays, and columns of others (`times`: exchange.py, `begin_numbers`:
 * begin_record.py, `rates`: exchange_record.py). `tests/core/test_native_image.py` holds them against the Python sources. */
#ifndef TLISMNI_CODES_H
#define TLISMNI_CODES_H

#include <stdint.h>

/* GOALS and COUNTS (state/run_records.py), COUNTERS (state/workspace_records.py) */
typedef struct {
    double goal, last_stop, handled_at, passed;
} Goals;

typedef struct {
    int64_t budget, handled, here, events, status, cause, remedy, attempts, answer;
} Counts;

typedef struct {
    int64_t steps, rejected, outer, inner, factorizations, partitions, evaluations, stages, analyses, krylov, of_impulses,
        impacts_in_rounds, unshared_loads, left_approaches, unfinished_sweeps;
} Counters;

enum { NOW, ASKED_TIME, LAST_CHANGE, INTERVAL };        /* columns of `times` */
enum { UNANSWERED, NOT_DONE, REMEDY_DONE, OTHER_ROWS }; /* `answer` of Counts */
enum { T0 = 0 };
enum { FIRST_RATE, SECOND_RATE, RATES_SINCE, RATES_SIZE };
enum { EVENT_SIZE = 10, GAINS = 7 };

/* failures of steps (state/workspace_records.py) */
enum { OUTER_DIVERGED = 1, INNER_DIVERGED, SINGULAR, REANALYZE, NOT_FINITE, OUTER_SLOW };

/* what `drive` and `exchange` return */
enum {
    REACHED = 100, EVENT, FULL, CHUNK, STEP_TOO_SMALL, REPARTITION, NEAR_SINGULAR, VIOLATED, UNLOCATED, DUE, SETTLE_IT,
    JAM, WANTED, EVENT_FAILED, DIVIDES, GOES_BY_IMPULSES, LAST_RESORT, FALL_BACK, UNREPAIRED, ARRIVED = 201, WAS_READ
};

/* what settling an instant returns (events/records.py) */
enum { SETTLED = 0, NOT_SETTLED, WANTS_ROOM, WANT_MEMORY };

/* beyond those: statuses of this code, and those of settling behind SETTLING */
enum {
    SETTLING = 300, RAISED = 400, NEEDS_EVENT, NEEDS_ROWS, TOO_MANY_STEPS, HAS_FAILED, WRONG_TIME, WRONG_INPUT,
    INPUT_REFUSED, NOT_READ, NOT_PACKED, NO_PARAMETER, OUT_OF_RANGE, HAS_BEGUN, NO_DERIVATIVES, NO_BEGINNING, EXCLUDED,
    NOT_RESTORED, DONE
};

/* what `restore_matrices` returns (assembly/matrix_state.py) */
enum { KEPT, BUILT };

#endif
