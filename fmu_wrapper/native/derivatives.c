/* Derivatives: of outputs along inputs, and in time. */

#include "native_slave.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../fmi/functions.h"

#define LOOKABLE (IN(INITIALIZATION) | IN(STEP_MODE) | IN(EVENT_DUE) | IN(EVENT_MODE))
#define RUNNING (IN(STEP_MODE) | IN(INTERMEDIATE) | IN(EVENT_DUE) | IN(EVENT_MODE) | IN(TERMINATED))

/* Memory for one question: derivatives of all channels, a direction, and a state. NULL with a line in the log. */
static double *room_of(Slave *self, const char *function) {
    if (!self->room) {
        size_t numbers = tlismni_count(self->model, TLISMNI_CHANNEL) + tlismni_count(self->model, TLISMNI_INPUT);
        self->room = malloc(numbers * sizeof(double) + tlismni_state_size(self->model));
        if (!self->room) {
            native_error(self, function, "there is no memory left for derivatives");
        }
    }
    return self->room;
}

/* The variable behind a reference if it is a real of one of two sources; NULL with a line in the log. */
static const Variable *of_source(const Slave *self, const char *function, uint32_t reference, Source one, Source other,
                                 const char *what) {
    const Variable *v = native_variable(self, function, reference, REAL);
    if (v && v->source != (int32_t)one && v->source != (int32_t)other) {
        native_error(self, function, "value reference %lu is no %s: derivatives are those of outputs with respect to inputs",
                    (unsigned long)reference, what);
        return NULL;
    }
    return v;
}

/* All channels along the direction behind them in `room`. */
static int along(Slave *self, const char *function, double *room) {
    size_t channels = tlismni_count(self->model, TLISMNI_CHANNEL), inputs = tlismni_count(self->model, TLISMNI_INPUT);
    int status = tlismni_derivatives(self->run, room + channels, room, room + channels + inputs);
    return status ? native_run_error(self, function, status) : STATUS_OK;
}

/* Are these lists of outputs and inputs, and may they be asked about now? */
static bool may_ask(Slave *self, const char *function, const Question *q) {
    if (!native_may(self, function, LOOKABLE)) {
        return false;
    }
    for (size_t k = 0; k < q->unknowns; k++) {
        if (!of_source(self, function, q->unknown[k], CHANNEL, EVENT_COUNT, "output")) {
            return false;
        }
    }
    for (size_t k = 0; k < q->knowns; k++) {
        if (!of_source(self, function, q->known[k], INPUT, INPUT, "input")) {
            return false;
        }
    }
    for (size_t k = 0; k < q->seeds; k++) {
        if (!isfinite(q->seed[k])) {
            native_error(self, function, "the seed is not finite");
            return false;
        }
    }
    return native_look_at_all(self, function) == STATUS_OK;
}

static int check_finite(const Slave *self, const char *function, double x) {
    return isfinite(x) ? STATUS_OK : native_error(self, function, "derivatives are not finite: inputs or seed are too large");
}

/* One derivative for each of `unknowns`. */
static int directional(Slave *self, const char *function, const Question *q) {
    size_t channels = tlismni_count(self->model, TLISMNI_CHANNEL), inputs = tlismni_count(self->model, TLISMNI_INPUT);
    double *room = may_ask(self, function, q) ? room_of(self, function) : NULL;
    if (!room) {
        return STATUS_ERROR;
    }
    memset(room + channels, 0, inputs * sizeof *room);
    for (size_t k = 0; k < q->knowns; k++) {
        room[channels + (size_t)self->variables[q->known[k] - 1].number] += q->seed[k];
    }
    int status = along(self, function, room);
    for (size_t k = 0; k < q->unknowns && status == STATUS_OK; k++) {
        q->sensitivity[k] = room[self->variables[q->unknown[k] - 1].number];
        status = check_finite(self, function, q->sensitivity[k]);
    }
    return status;
}

/* One derivative for each of `knowns`. */
static int adjoint(Slave *self, const char *function, const Question *q) {
    size_t channels = tlismni_count(self->model, TLISMNI_CHANNEL), inputs = tlismni_count(self->model, TLISMNI_INPUT);
    double *room = may_ask(self, function, q) ? room_of(self, function) : NULL;
    if (!room) {
        return STATUS_ERROR;
    }
    for (size_t j = 0; j < q->knowns; j++) {
        memset(room + channels, 0, inputs * sizeof *room);
        room[channels + (size_t)self->variables[q->known[j] - 1].number] = 1.0;
        if (along(self, function, room) != STATUS_OK) {
            return STATUS_ERROR;
        }
        double sum = 0.0;
        for (size_t k = 0; k < q->unknowns; k++) {
            sum += q->seed[k] * room[self->variables[q->unknown[k] - 1].number];
        }
        if (check_finite(self, function, sum) != STATUS_OK) {
            return STATUS_ERROR;
        }
        q->sensitivity[j] = sum;
    }
    return STATUS_OK;
}

/* The same with the elements of arrays as unknowns, of which seed or sensitivities has as many. */
static int with_elements(Slave *self, const char *function, const Question *given, bool back) {
    Question q = *given;
    Elements e;
    int status = STATUS_ERROR;
    if (!is_of_length(self, function, q.knowns, back ? q.sensitivities : q.seeds)) {
        return status;
    }
    if (native_elements(self, function, q.unknown, q.unknowns, NULL, back ? q.seeds : q.sensitivities, &e)) {
        q.unknown = e.vr;
        q.unknowns = e.n;
        status = (back ? adjoint : directional)(self, function, &q);
    }
    native_elements_end(&e);
    return status;
}

int slave_directional(Slave *self, const char *function, const Question *question) {
    return with_elements(self, function, question, false);
}

int slave_adjoint(Slave *self, const char *function, const Question *question) {
    return with_elements(self, function, question, true);
}

static int output_derivatives(Slave *self, const char *function, const uint32_t vr[], size_t n, const int32_t order[],
                              double value[]) {
    if (!native_may(self, function, RUNNING)) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < n; k++) {
        if (!of_source(self, function, vr[k], CHANNEL, EVENT_COUNT, "output")) {
            return STATUS_ERROR;
        }
        if (order[k] != 1) {
            return native_error(self, function, "a derivative of order %ld was asked: there are those of order 1 "
                               "(maxOutputDerivativeOrder)", (long)order[k]);
        }
    }
    double *room = room_of(self, function);
    if (!room || native_look_at_all(self, function) != STATUS_OK) {
        return STATUS_ERROR;
    }
    size_t channels = tlismni_count(self->model, TLISMNI_CHANNEL), inputs = tlismni_count(self->model, TLISMNI_INPUT);
    int status = tlismni_rates(self->run, room, room + channels + inputs);
    if (status) {
        return native_run_error(self, function, status);
    }
    for (size_t k = 0; k < n; k++) {
        size_t number = (size_t)self->variables[vr[k] - 1].number;
        if (!isfinite(room[number])) {
            const char *name = tlismni_name(self->model, TLISMNI_CHANNEL, number);
            return native_error(self, function, "the time derivative of '%s' is not known exactly: there are "
                      "those of positions, velocities, gaps, gap rates, impulses, work and dissipation; take the difference "
                      "of two steps", name ? name : "?");
        }
        value[k] = room[number];
    }
    return STATUS_OK;
}

int slave_output_derivatives(Slave *self, const char *function, const uint32_t vr[], size_t n, const int32_t order[],
                             double value[], size_t values) {
    Elements e;
    bool found = native_elements(self, function, vr, n, order, values, &e);
    int status = found ? output_derivatives(self, function, e.vr, e.n, e.order, value) : STATUS_ERROR;
    native_elements_end(&e);
    return status;
}
