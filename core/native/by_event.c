/* From one contact event to the next, or from one step of the solver to the next: `Simulation.advance_to_event`,
 * `handle_event` and `next_point`. */

#include "codes.h"
#include "image.h"
#include "advance.h"

#include <math.h>

/* Where a step must end because the inputs are expected to change (`inputs.py`). */
static double stop_of(const tlismni_run *run, double t) {
    const double *times = REALS(run, times);
    double expected = times[LAST_CHANGE] + times[INTERVAL];
    if (!(run->beside.now < expected && expected < INFINITY)) {
        return INFINITY;
    }
    return expected <= t + run->model->numbers.punctual * times[INTERVAL] ? t : expected;
}

tlismni_status tlismni_step_to_event(tlismni_run *run, double t, bool *event) {
    *event = false;
    tlismni_status status = advance_begin(run, t);
    if (status != TLISMNI_OK) {
        return status;
    }
    double start = run->beside.now, stop = stop_of(run, t);
    Goals *goals = GOALS(run);
    int64_t first = advance_used(run);
    for (;;) {
        while (status == TLISMNI_OK && tlismni_event_due(run)) {
            status = advance_settle(run);
        }
        if (status != TLISMNI_OK) {
            return advance_end(run, status);
        }
        goals->goal = t;
        goals->last_stop = stop;
        status = advance_go_on(run, CHUNK, true, first, COUNTS(run)->events);
        if (status != TLISMNI_OK) {
            return advance_end(run, status);
        }
        double computed = tlismni_computed(run);
        if (!advance_any_pending(run) || computed > t) {
            advance_arrive(run, t);
            return TLISMNI_OK;
        }
        advance_arrive(run, computed);
        if (computed > start) {
            *event = true;
            return TLISMNI_OK;
        }
    }
}

tlismni_status tlismni_next_point(tlismni_run *run, double t, double *point) {
    *point = run->beside.now;
    tlismni_status status = advance_begin(run, t);
    if (status != TLISMNI_OK) {
        return status;
    }
    double now = run->beside.now, stop = stop_of(run, t);
    Goals *goals = GOALS(run);
    int64_t first = advance_used(run);
    while (status == TLISMNI_OK && tlismni_event_due(run)) {
        status = advance_settle(run);
    }
    if (status == TLISMNI_OK && tlismni_computed(run) <= now) {
        goals->goal = now + 8.0 * (nextafter(fabs(now), INFINITY) - fabs(now)); /* no step ends before that */
        goals->last_stop = stop;
        status = advance_go_on(run, CHUNK, true, first, COUNTS(run)->events);
    }
    *point = fmin(tlismni_computed(run), t);
    return advance_end(run, status);
}

tlismni_status tlismni_happen(tlismni_run *run, bool *again) {
    *again = false;
    tlismni_status status = advance_begin(run, run->beside.now);
    if (status == TLISMNI_OK && tlismni_event_due(run)) {
        status = advance_settle(run);
        *again = status == TLISMNI_OK && tlismni_event_due(run);
    }
    return status == INPUT_REFUSED ? status : advance_end(run, status);
}
