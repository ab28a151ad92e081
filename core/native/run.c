/* Runs: memory of their own, and what can be asked of them. */

#include "image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "codes.h"
#include "pieces.h"

static size_t head_size(void) {
    return (sizeof(tlismni_run) + ALIGNED - 1) / ALIGNED * ALIGNED;
}

size_t tlismni_run_size(const tlismni_model *model) {
    return head_size() + (size_t)model->head.own;
}


/* The memory at the start; `blank`: it is zero already where it has no content. */
static void lay_out(tlismni_run *run, bool blank) {
    const tlismni_model *m = run->model;
    pieces_touch();
    run->beside = (Beside){m->numbers.start, 0, 0, 0};
    run->noted = (Noted){m->numbers.events, 0};
    memcpy(run->own, m->own_bytes, (size_t)m->head.copied);
    if (!blank) {
        memset(run->own + m->head.copied, 0, (size_t)(m->head.own - m->head.copied));
    }
    int64_t *words = (int64_t *)run->own;
    for (int64_t k = 0; k < m->head.own_own; k++) {
        words[m->own_own[k]] += (int64_t)(intptr_t)run->own;
    }
    for (int64_t k = 0; k < m->head.own_shared; k++) {
        words[m->own_shared[k]] += (int64_t)(intptr_t)m->shared;
    }
    for (int64_t k = 0; k < m->head.own_function; k++) {
        words[m->own_function[k]] = (int64_t)(intptr_t)m->functions[words[m->own_function[k]]];
    }
}

static tlismni_run *start_in(const tlismni_model *m, void *memory, bool blank) {
    tlismni_run *run = memory;
    memset(run, 0, sizeof *run);
    run->model = m;
    run->own = (char *)memory + head_size();
    run->limit = m->numbers.most_steps;
    lay_out(run, blank);
    return run;
}

tlismni_run *tlismni_start_in(const tlismni_model *m, void *memory, size_t size) {
    if (!memory || (uintptr_t)memory % ALIGNED || size < tlismni_run_size(m)) {
        return NULL;
    }
    return start_in(m, memory, false);
}

void tlismni_restart(tlismni_run *run) {
    lay_out(run, false);
}

tlismni_run *tlismni_start(const tlismni_model *model) {
    char *allocated = calloc(1, tlismni_run_size(model) + ALIGNED);
    if (!allocated) {
        return NULL;
    }
    tlismni_run *run = start_in(model, (char *)(((uintptr_t)allocated + ALIGNED - 1) / ALIGNED * ALIGNED), true);
    run->allocated = allocated;
    return run;
}

void tlismni_end(tlismni_run *run) {
    if (run) {
        free(run->allocated);
    }
}

double tlismni_time(const tlismni_run *run) {
    return run->beside.now;
}

double tlismni_computed(const tlismni_run *run) {
    return REALS(run, method_times)[WHOLES(run, ring)[0]];
}

double *tlismni_inputs(tlismni_run *run) {
    return REALS(run, inputs);
}

tlismni_status tlismni_set_rates(tlismni_run *run, size_t number, double first, double second) {
    if (number >= (size_t)run->model->numbers.inputs || !isfinite(first) || !isfinite(second)) {
        return WRONG_INPUT;
    }
    double *rates = REALS(run, rates) + RATES_SIZE * number;
    rates[FIRST_RATE] = first;
    rates[SECOND_RATE] = second;
    rates[RATES_SINCE] = run->beside.now;
    return TLISMNI_OK;
}

void tlismni_rates_of(const tlismni_run *run, size_t number, double *first, double *second, double *since) {
    const double *rates = REALS(run, rates) + RATES_SIZE * number;
    *first = rates[FIRST_RATE];
    *second = rates[SECOND_RATE];
    *since = rates[RATES_SINCE];
}

const double *tlismni_channels(const tlismni_run *run) {
    return REALS(run, channels);
}

int64_t tlismni_event_count(const tlismni_run *run) {
    return run->noted.events;
}

int64_t tlismni_steps(const tlismni_run *run) {
    return COUNTERS(run)->steps;
}

void tlismni_limit_steps(tlismni_run *run, int64_t steps) {
    run->limit = steps > 0 ? steps : INT64_MAX;
}

size_t tlismni_events(tlismni_run *run, tlismni_event *events, size_t room) {
    const double *row = REALS(run, events);
    size_t found = 0;
    for (int64_t k = 0; k < COUNTS(run)->events; k++, row += EVENT_SIZE) {
        if ((int)row[1] >= GAINS) {
            continue; /* what only warnings in Python tell of */
        }
        if (found < room) {
            events[found] = (tlismni_event){row[0], (int)row[1], (int)row[2], row[3], row[4], row[5], row[6], row[7],
                                            row[8]};
        }
        found++;
    }
    COUNTS(run)->events = 0;
    return found;
}
