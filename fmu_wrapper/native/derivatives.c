/* Derivatives: of outputs along inputs, and in time. */

#include "slave.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LOOKABLE (IN(INITIALIZATION) | IN(STEP_MODE) | IN(EVENT_DUE) | IN(EVENT_MODE))
#define RUNNING (IN(STEP_MODE) | IN(INTERMEDIATE) | IN(EVENT_DUE) | IN(EVENT_MODE) | IN(TERMINATED))

/* Memory for one question: derivatives of all channels, a direction, and a state. NULL with a line in the log. */
static double *room_of(Slave *self, const char *function) {
    if (!self->room) {
        size_t numbers = tlismni_count(self->model, TLISMNI_CHANNEL) + tlismni_count(self->model, TLISMNI_INPUT);
        self->room = malloc(numbers * sizeof(double) + tlismni_state_size(self->model));
        if (!self->room) {
            slave_error(self, function, "there is no memory left for derivatives");
        }
    }
    return self->room;
}

/* The variable behind a reference if it is a real of one of two sources; NULL with a line in the log. */
static const Variable *of_source(const Slave *self, const char *function, uint32_t reference, Source one, Source other,
                                 const char *what) {
    const Variable *v = slave_variable(self, function, reference, REAL);
    if (v && v->source != (int32_t)one && v->source != (int32_t)other) {
        slave_error(self, function, "value reference %lu is no %s: derivatives are those of outputs with respect to inputs",
                    (unsigned long)reference, what);
        return NULL;
    }
    return v;
}

/* All channels along the direction behind them in `room`. */
static int along(Slave *self, const char *function, double *room) {
    size_t channels = tlismni_count(self->model, TLISMNI_CHANNEL), inputs = tlismni_count(self->model, TLISMNI_INPUT);
    int status = tlismni_derivatives(self->run, room + channels, room, room + channels + inputs);
    return status ? slave_run_error(self, function, status) : STATUS_OK;
}

/* Are these lists of outputs and inputs, and may they be asked about now? */
static bool may_ask(Slave *self, const char *function, const uint32_t unknown[], size_t unknowns, const uint32_t known[],
                    size_t knowns, const double seed[], size_t seeds, const double result[], size_t results) {
    if (!slave_may(self, function, LOOKABLE) || !slave_has_room(self, function, unknown, unknowns) ||
        !slave_has_room(self, function, known, knowns) || !slave_has_room(self, function, seed, seeds) ||
        !slave_has_room(self, function, result, results)) {
        return false;
    }
    for (size_t k = 0; k < unknowns; k++) {
        if (!of_source(self, function, unknown[k], CHANNEL, EVENT_COUNT, "output")) {
            return false;
        }
    }
    for (size_t k = 0; k < knowns; k++) {
        if (!of_source(self, function, known[k], INPUT, INPUT, "input")) {
            return false;
        }
    }
    for (size_t k = 0; k < seeds; k++) {
        if (!isfinite(seed[k])) {
            slave_error(self, function, "the seed is not finite");
            return false;
        }
    }
    return slave_look_at_all(self, function) == STATUS_OK;
}

static int check_finite(const Slave *self, const char *function, double x) {
    return isfinite(x) ? STATUS_OK : slave_error(self, function, "derivatives are not finite: inputs or seed are too large");
}

int slave_directional(Slave *self, const char *function, const uint32_t unknown[], size_t unknowns, const uint32_t known[],
                      size_t knowns, const double seed[], double sensitivity[]) {
    if (!may_ask(self, function, unknown, unknowns, known, knowns, seed, knowns, sensitivity, unknowns)) {
        return STATUS_ERROR;
    }
    size_t channels = tlismni_count(self->model, TLISMNI_CHANNEL), inputs = tlismni_count(self->model, TLISMNI_INPUT);
    double *room = room_of(self, function);
    if (!room) {
        return STATUS_ERROR;
    }
    memset(room + channels, 0, inputs * sizeof *room);
    for (size_t k = 0; k < knowns; k++) {
        room[channels + (size_t)self->variables[known[k] - 1].number] += seed[k];
    }
    int status = along(self, function, room);
    for (size_t k = 0; k < unknowns && status == STATUS_OK; k++) {
        sensitivity[k] = room[self->variables[unknown[k] - 1].number];
        status = check_finite(self, function, sensitivity[k]);
    }
    return status;
}

int slave_adjoint(Slave *self, const char *function, const uint32_t unknown[], size_t unknowns, const uint32_t known[],
                  size_t knowns, const double seed[], double sensitivity[]) {
    if (!may_ask(self, function, unknown, unknowns, known, knowns, seed, unknowns, sensitivity, knowns)) {
        return STATUS_ERROR;
    }
    size_t channels = tlismni_count(self->model, TLISMNI_CHANNEL), inputs = tlismni_count(self->model, TLISMNI_INPUT);
    double *room = room_of(self, function);
    if (!room) {
        return STATUS_ERROR;
    }
    for (size_t j = 0; j < knowns; j++) {
        memset(room + channels, 0, inputs * sizeof *room);
        room[channels + (size_t)self->variables[known[j] - 1].number] = 1.0;
        if (along(self, function, room) != STATUS_OK) {
            return STATUS_ERROR;
        }
        double sum = 0.0;
        for (size_t k = 0; k < unknowns; k++) {
            sum += seed[k] * room[self->variables[unknown[k] - 1].number];
        }
        if (check_finite(self, function, sum) != STATUS_OK) {
            return STATUS_ERROR;
        }
        sensitivity[j] = sum;
    }
    return STATUS_OK;
}

int slave_output_derivatives(Slave *self, const char *function, const uint32_t vr[], size_t n, const int32_t order[],
                             double value[]) {
    if (!slave_may(self, function, RUNNING) || !slave_has_room(self, function, vr, n) ||
        !slave_has_room(self, function, order, n) || !slave_has_room(self, function, value, n)) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < n; k++) {
        if (!of_source(self, function, vr[k], CHANNEL, EVENT_COUNT, "output")) {
            return STATUS_ERROR;
        }
        if (order[k] != 1) {
            return slave_error(self, function, "a derivative of order %ld was asked: there are those of order 1 "
                               "(maxOutputDerivativeOrder)", (long)order[k]);
        }
    }
    double *room = room_of(self, function);
    if (!room || slave_look_at_all(self, function) != STATUS_OK) {
        return STATUS_ERROR;
    }
    size_t channels = tlismni_count(self->model, TLISMNI_CHANNEL), inputs = tlismni_count(self->model, TLISMNI_INPUT);
    int status = tlismni_rates(self->run, room, room + channels + inputs);
    if (status) {
        return slave_run_error(self, function, status);
    }
    for (size_t k = 0; k < n; k++) {
        size_t number = (size_t)self->variables[vr[k] - 1].number;
        if (!isfinite(room[number])) {
            const char *name = tlismni_name(self->model, TLISMNI_CHANNEL, number);
            return slave_error(self, function, "the time derivative of '%s' is not known exactly: there are "
                      "those of positions, velocities, gaps, gap rates, impulses, work and dissipation; take the difference "
                      "of two steps", name ? name : "?");
        }
        value[k] = room[number];
    }
    return STATUS_OK;
}
