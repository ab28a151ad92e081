/* The way on: what `exchange`, `advance.py` and `answers.py` do in Python, as far as it takes none. */

#include "codes.h"
#include "image.h"
#include "advance.h"

#include <math.h>

/* Calls of compiled code follow numba's convention: places of the result and of what is raised come first. */

typedef int32_t (*OfRecord)(void *result, void **raised, void *record);
typedef int32_t (*OfDrive)(void *result, void **raised, void *record, bool hold);

/* What a function of one record returns; RAISED if it has raised something. */
static int64_t call(tlismni_run *run, int which, int64_t place) {
    int64_t result = 0; /* of a truth value only the first byte is written */
    void *raised = NULL;
    int32_t status = ((OfRecord)run->model->functions[which])(&result, &raised, run->own + place);
    return status == 0 ? result : RAISED;
}

/* `drive`, to the goal or, to `hold`, until events are pending. */
static int64_t go(tlismni_run *run, bool hold) {
    int64_t result = 0;
    void *raised = NULL;
    int32_t status = ((OfDrive)run->model->functions[DRIVE])(&result, &raised, run->own + run->model->places.drive, hold);
    return status == 0 ? result : RAISED;
}

/* Count the events that compiled code has reported from row `first` on. */
static void count_events(tlismni_run *run, int64_t first) {
    const double *rows = REALS(run, events);
    int64_t count = COUNTS(run)->events;
    for (int64_t k = first; k < count; k++) {
        run->noted.events += rows[EVENT_SIZE * k + 1] < (double)GAINS;
    }
}

/* Forget reported events, so that there is room for more. */
static void drop_events(tlismni_run *run) {
    COUNTS(run)->events = 0;
}

bool advance_any_pending(const tlismni_run *run) {
    const int64_t *pending = WHOLES(run, pending);
    for (int64_t k = 0; k < run->model->numbers.contacts; k++) {
        if (pending[k]) {
            return true;
        }
    }
    return false;
}

bool tlismni_event_due(const tlismni_run *run) {
    return advance_any_pending(run) && tlismni_computed(run) == run->beside.now;
}

int64_t advance_used(const tlismni_run *run) {
    return COUNTERS(run)->steps + COUNTS(run)->handled;
}

/* Other pivots where the policy asks for them: redundant rows that are left out stay so, those of the image, all along. */
static tlismni_status repair(tlismni_run *run) {
    Counts *counts = COUNTS(run);
    int64_t status = call(run, REPAIR, run->model->places.drive);
    if (status == WANTS_ROOM || status == WANT_MEMORY || status >= RAISED) {
        return (tlismni_status)(status < RAISED ? SETTLING + status : status);
    }
    counts->status = status;
    counts->answer = status == SETTLED ? REMEDY_DONE : NOT_DONE;
    return TLISMNI_OK;
}

/* What has to be done after `drive` has returned `code` (`recovery/policy.py`); DONE at the end of the way. */
static tlismni_status after(tlismni_run *run, int64_t code, bool hold) {
    Counts *counts = COUNTS(run);
    switch (code) {
    case REACHED:
    case ARRIVED:
    case WAS_READ:
        return DONE;
    case CHUNK:
    case DIVIDES:
    case GOES_BY_IMPULSES:
        return TLISMNI_OK;
    case SETTLE_IT:
        if (hold || tlismni_computed(run) > GOALS(run)->goal) {
            return DONE;
        }
        if (counts->events) { /* there may be no room for more events */
            drop_events(run);
            return TLISMNI_OK;
        }
        return run->model->numbers.redundant ? NEEDS_ROWS : NEEDS_EVENT;
    case WANTED:
    case EVENT_FAILED:
    case UNREPAIRED:
        return (tlismni_status)(SETTLING + counts->status);
    case REPARTITION:
        return repair(run);
    case NEAR_SINGULAR:
    case LAST_RESORT:
    case FALL_BACK: /* only Python does these */
        return (tlismni_status)counts->cause;
    default:
        return (tlismni_status)code;
    }
}

tlismni_status advance_go_on(tlismni_run *run, int64_t code, bool hold, int64_t first, int64_t seen) {
    Counts *counts = COUNTS(run);
    for (;;) {
        count_events(run, seen);
        tlismni_status status = after(run, code, hold);
        seen = counts->events;
        if (status != TLISMNI_OK) {
            return status == DONE ? TLISMNI_OK : status;
        }
        int64_t left = run->limit - (advance_used(run) - first);
        if (left <= 0) {
            return TOO_MANY_STEPS;
        }
        counts->budget = left < run->model->numbers.chunk ? left : run->model->numbers.chunk;
        code = go(run, hold);
    }
}

/* Begin anew, with parameters or a start time that are not those of the image. */
static tlismni_status begin_anew(tlismni_run *run) {
    run->noted.beginning = ++run->beginnings;
    int64_t status = call(run, BEGIN, run->model->places.begin);
    if (status != SETTLED) {
        return (tlismni_status)(status < RAISED ? SETTLING + status : status);
    }
    run->noted.events = 0;
    count_events(run, 0);
    run->beside.stale = 0;
    return TLISMNI_OK;
}

tlismni_status advance_begin(tlismni_run *run, double t) {
    double *times = REALS(run, times);
    if (run->beside.failed) {
        return HAS_FAILED;
    }
    if (!(isfinite(t) && t >= run->beside.now)) {
        return WRONG_TIME;
    }
    for (int64_t k = 0; k < run->model->numbers.inputs; k++) {
        if (!isfinite(REALS(run, inputs)[k])) {
            return WRONG_INPUT;
        }
    }
    run->beside.begun = 1;
    if (run->beside.stale) {
        tlismni_status status = begin_anew(run);
        if (status != TLISMNI_OK) {
            return status;
        }
    }
    COUNTS(run)->events = 0;
    times[NOW] = run->beside.now;
    times[ASKED_TIME] = t;
    bool told = !run->model->numbers.inputs || call(run, TELL, run->model->places.exchange) == 1;
    return told ? TLISMNI_OK : INPUT_REFUSED;
}

void advance_arrive(tlismni_run *run, double t) {
    double duration = t - run->beside.now, *inputs = REALS(run, inputs), *rates = REALS(run, rates);
    for (int64_t k = 0; k < run->model->numbers.inputs; k++, rates += RATES_SIZE) {
        if (rates[FIRST_RATE] != 0.0 || rates[SECOND_RATE] != 0.0) {
            inputs[k] += duration * (rates[FIRST_RATE] + 0.5 * duration * rates[SECOND_RATE]);
            rates[FIRST_RATE] += duration * rates[SECOND_RATE];
        }
    }
    run->beside.now = t;
}

tlismni_status advance_end(tlismni_run *run, tlismni_status status) {
    if (status != TLISMNI_OK && status != INPUT_REFUSED) {
        run->beside.failed = 1;
    }
    return status;
}

tlismni_status advance_read(tlismni_run *run, double t) {
    REALS(run, times)[ASKED_TIME] = t;
    return call(run, READ, run->model->places.exchange) == 1 ? TLISMNI_OK : NOT_READ;
}

/* `want` of read_channels.py: a channel, all (-1), or none (-2). */
typedef int32_t (*Want)(int64_t *result, void **raised, void *record, int64_t channel);

static bool want(tlismni_run *run, int64_t channel) {
    int64_t more = 0;
    void *raised = NULL;
    ((Want)run->model->functions[WANT])(&more, &raised, run->own + run->model->places.exchange, channel);
    return more & 1;
}

bool tlismni_want(tlismni_run *run, size_t number) {
    return want(run, number < (size_t)run->model->numbers.channels ? (int64_t)number : -1);
}

void tlismni_want_none(tlismni_run *run) {
    want(run, -2);
}

tlismni_status tlismni_step(tlismni_run *run, double t, bool read) {
    tlismni_status status = advance_begin(run, t);
    if (status != TLISMNI_OK) {
        return status;
    }
    int64_t first = advance_used(run);
    *WHOLES(run, reads) = read;
    *WHOLES(run, budget) = run->limit < run->model->numbers.chunk ? run->limit : run->model->numbers.chunk;
    int64_t code = call(run, EXCHANGE, run->model->places.exchange);
    status = advance_go_on(run, code, false, first, 0);
    if (status == TLISMNI_OK) {
        advance_arrive(run, t);
        if (read && code != WAS_READ) {
            status = advance_read(run, t);
        }
    }
    return advance_end(run, status);
}

tlismni_status tlismni_look(tlismni_run *run) {
    tlismni_status status = advance_begin(run, run->beside.now);
    return status == TLISMNI_OK ? advance_end(run, advance_read(run, run->beside.now)) : status;
}

tlismni_status advance_settle(tlismni_run *run) {
    int64_t first = COUNTS(run)->events;
    if (run->model->numbers.redundant) {
        return NEEDS_ROWS;
    }
    int64_t status = call(run, SETTLE, run->model->places.drive);
    if (status == NOT_SETTLED && first) {
        drop_events(run);
        first = 0;
        status = call(run, SETTLE, run->model->places.drive);
    }
    count_events(run, first);
    if (status == SETTLED) {
        return TLISMNI_OK;
    }
    return (tlismni_status)(status == NOT_SETTLED ? NEEDS_EVENT : status < RAISED ? SETTLING + status : status);
}
