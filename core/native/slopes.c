/* Derivatives of channels at the present time: along inputs, and in time (`simulation/slopes.py`). */

#include "codes.h"
#include "image.h"
#include "advance.h"

#include <math.h>
#include <string.h>

/* An array of reals as numba passes it: owner, parent, length, size of an item, data, shape, strides. */
#define REAL_ARRAY(data, count) NULL, NULL, (int64_t)(count), (int64_t)sizeof(double), (data), (int64_t)(count), (int64_t)sizeof(double)
#define REAL_TYPES void *, void *, int64_t, int64_t, double *, int64_t, int64_t

typedef int32_t (*Along)(int64_t *result, void **raised, void *record, REAL_TYPES, REAL_TYPES);
typedef int32_t (*InTime)(void **result, void **raised, void *record, REAL_TYPES);

/* Have the present time as the point that compiled code works on, and keep in `room` what that must not change. */
static tlismni_status look_closely(tlismni_run *run, void *room) {
    tlismni_status status = advance_begin(run, run->beside.now);
    if (status != TLISMNI_OK) {
        return status;
    }
    tlismni_save(run, room);
    tlismni_want(run, TLISMNI_ALL);
    status = advance_read(run, run->beside.now);
    if (status != TLISMNI_OK) {
        (void)tlismni_restore(run, room);
    }
    return status;
}

tlismni_status tlismni_derivatives(tlismni_run *run, const double *direction, double *found, void *room) {
    const tlismni_model *m = run->model;
    size_t inputs = (size_t)m->numbers.inputs, channels = (size_t)m->numbers.channels;
    double largest = 0.0;
    memset(found, 0, channels * sizeof *found);
    for (size_t k = 0; k < inputs; k++) {
        if (!isfinite(direction[k])) {
            return WRONG_INPUT;
        }
        largest = fmax(largest, fabs(direction[k]));
    }
    if (largest == 0.0) {
        return TLISMNI_OK;
    }
    tlismni_status status = look_closely(run, room);
    if (status != TLISMNI_OK) {
        return status;
    }
    double *seed = REALS(run, inputs); /* which `room` has too */
    for (size_t k = 0; k < inputs; k++) {
        seed[k] = direction[k] / largest;
    }
    int64_t result = 0;
    void *raised = NULL;
    int32_t code = ((Along)m->functions[ALONG])(&result, &raised, run->own + m->places.exchange, REAL_ARRAY(seed, inputs),
                                                REAL_ARRAY(found, channels));
    status = tlismni_restore(run, room);
    for (size_t k = 0; k < channels; k++) {
        found[k] *= largest;
    }
    return status != TLISMNI_OK ? status : code == 0 && result == 0 ? TLISMNI_OK : NO_DERIVATIVES;
}

tlismni_status tlismni_rates(tlismni_run *run, double *found, void *room) {
    const tlismni_model *m = run->model;
    tlismni_status status = look_closely(run, room);
    if (status != TLISMNI_OK) {
        return status;
    }
    void *result = NULL, *raised = NULL;
    int32_t code = ((InTime)m->functions[IN_TIME])(&result, &raised, run->own + m->places.exchange,
                                                   REAL_ARRAY(found, m->numbers.channels));
    status = tlismni_restore(run, room);
    return status != TLISMNI_OK ? status : code == 0 ? TLISMNI_OK : NO_DERIVATIVES;
}
