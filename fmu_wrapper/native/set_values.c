/* Values of inputs and parameters are set. */

#include "native_slave.h"

#include <math.h>
#include <string.h>

#define SETTABLE (IN(INSTANTIATED) | IN(INITIALIZATION) | IN(STEP_MODE) | IN(INTERMEDIATE) | IN(EVENT_DUE) | IN(EVENT_MODE))

static int refuse(const Slave *self, const char *function, uint32_t reference) {
    return native_error(self, function, "value reference %lu cannot be set: it is neither an input nor a parameter that an "
                       "FMU without Python can change; export it with another value, or with Python",
                       (unsigned long)reference);
}

static bool among(const uint32_t references[], size_t count, uint32_t one) {
    for (size_t k = 0; k < count; k++) {
        if (references[k] == one) {
            return true;
        }
    }
    return false;
}

/* Whether a value may be set now; false with a line in the log. */
static bool may_set(const Slave *self, const char *function, const Variable *v, uint32_t reference, double value) {
    if (v->source != INPUT && v->source != PARAMETER) {
        refuse(self, function, reference);
        return false;
    }
    if (v->source == PARAMETER && self->phase != INSTANTIATED && self->phase != INITIALIZATION) {
        native_error(self, function, "value reference %lu is a parameter, which is fixed after initialization: reset, then "
                    "set it before", (unsigned long)reference);
        return false;
    }
    if (self->phase == INTERMEDIATE && !among(self->intermediate, self->intermediates, reference)) {
        native_error(self, function, "in an intermediate update only the required intermediate variables can be set, not value "
                    "reference %lu: name it when the instance is made", (unsigned long)reference);
        return false;
    }
    if (!isfinite(value) || value < v->least || value > v->largest) {
        const char *name = tlismni_name(self->model, v->source == INPUT ? TLISMNI_INPUT : TLISMNI_PARAMETER,
                                        (size_t)v->number);
        native_error(self, function, "'%s' was set to %g, which is not finite or outside its range [%g, %g]: check what "
                    "feeds it", name ? name : "?", value, v->least, v->largest);
        return false;
    }
    return true;
}

void native_take_parameters(Slave *self) {
    size_t count = tlismni_count(self->model, TLISMNI_PARAMETER);
    for (size_t k = 0; k < count; k++) {
        self->parameters[k] = tlismni_parameter(self->run, k);
    }
    self->start = tlismni_start_time(self->run);
}

/* The run from its start with parameters and start time as they are now, and the inputs as they were. */
static int start_anew(Slave *self, const char *function) {
    size_t count = tlismni_count(self->model, TLISMNI_PARAMETER), inputs = tlismni_count(self->model, TLISMNI_INPUT);
    double *kept = self->parameters + 2 * count, *rates = kept + inputs, since;
    memcpy(kept, tlismni_inputs(self->run), inputs * sizeof *kept);
    for (size_t k = 0; k < inputs; k++) {
        tlismni_rates_of(self->run, k, rates + 2 * k, rates + 2 * k + 1, &since);
    }
    tlismni_restart(self->run);
    memcpy(tlismni_inputs(self->run), kept, inputs * sizeof *kept);
    int at = self->start == tlismni_time(self->run) ? TLISMNI_OK : tlismni_start_at(self->run, self->start);
    if (at) {
        return native_run_error(self, function, at);
    }
    for (size_t k = 0; k < count; k++) {
        int status = tlismni_set_parameter(self->run, k, self->parameters[k]);
        if (status) {
            return native_not_set(self, function, k, status);
        }
    }
    for (size_t k = 0; k < inputs; k++) { /* which all count as of now: nothing has moved yet */
        if (rates[2 * k] != 0.0 || rates[2 * k + 1] != 0.0) {
            tlismni_set_rates(self->run, k, rates[2 * k], rates[2 * k + 1]);
        }
    }
    return STATUS_OK;
}

/* The same; if these parameters cannot be together, with those before (which stand behind them). */
static int start_or_go_back(Slave *self, const char *function) {
    size_t count = tlismni_count(self->model, TLISMNI_PARAMETER);
    int status = start_anew(self, function);
    if (status != STATUS_OK) {
        memcpy(self->parameters, self->parameters + count, count * sizeof *self->parameters);
        start_anew(self, function);
    }
    return status;
}

static int set_reals(Slave *self, const char *function, const uint32_t vr[], size_t n, const double value[]) {
    if (!native_may(self, function, SETTABLE)) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < n; k++) { /* all of them or none */
        const Variable *v = native_variable(self, function, vr[k], REAL);
        if (!v || !may_set(self, function, v, vr[k], value[k])) {
            return STATUS_ERROR;
        }
    }
    double *inputs = tlismni_inputs(self->run), now = tlismni_time(self->run), first, second, since;
    bool changed = false;
    memcpy(self->parameters + tlismni_count(self->model, TLISMNI_PARAMETER), self->parameters,
           tlismni_count(self->model, TLISMNI_PARAMETER) * sizeof *self->parameters);
    for (size_t k = 0; k < n; k++) {
        const Variable *v = &self->variables[vr[k] - 1];
        changed = changed || v->source == PARAMETER;
        (v->source == INPUT ? inputs : self->parameters)[v->number] = value[k];
        if (v->source == INPUT) { /* derivatives end, unless they are of this time */
            tlismni_rates_of(self->run, (size_t)v->number, &first, &second, &since);
            if (since != now && (first != 0.0 || second != 0.0)) {
                tlismni_set_rates(self->run, (size_t)v->number, 0.0, 0.0);
            }
        }
    }
    self->fresh = self->fresh && !n;
    return changed ? start_or_go_back(self, function) : STATUS_OK;
}

int slave_set_reals(Slave *self, const char *function, const uint32_t vr[], size_t n, const double value[], size_t values) {
    Elements e;
    bool found = native_elements(self, function, vr, n, NULL, values, &e);
    int status = found ? set_reals(self, function, e.vr, e.n, value) : STATUS_ERROR;
    native_elements_end(&e);
    return status;
}

int slave_set_rates(Slave *self, const char *function, const uint32_t vr[], size_t n, const int32_t order[],
                    const double value[]) {
    if (!native_may(self, function, SETTABLE)) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < n; k++) { /* all of them or none */
        const Variable *v = native_variable(self, function, vr[k], REAL);
        if (!v) {
            return STATUS_ERROR;
        }
        if (v->source != INPUT || order[k] < 1 || order[k] > 2 || !isfinite(value[k])) {
            return native_error(self, function, "a derivative %g of order %ld of value reference %lu was given: only inputs take "
                               "derivatives, finite ones of orders 1 and 2", value[k], (long)order[k], (unsigned long)vr[k]);
        }
        if (!may_set(self, function, v, vr[k], v->start)) {
            return STATUS_ERROR;
        }
    }
    double now = tlismni_time(self->run), first, second, since;
    for (size_t k = 0; k < n; k++) {
        size_t number = (size_t)self->variables[vr[k] - 1].number;
        tlismni_rates_of(self->run, number, &first, &second, &since);
        if (since != now) { /* other orders end */
            first = second = 0.0;
        }
        *(order[k] == 1 ? &first : &second) = value[k];
        tlismni_set_rates(self->run, number, first, second);
    }
    self->fresh = self->fresh && !n;
    return STATUS_OK;
}

/* None but reals can be set. */
static int set_others(Slave *self, const char *function, const uint32_t vr[], size_t n) {
    if (!native_may(self, function, SETTABLE)) {
        return STATUS_ERROR;
    }
    return n ? refuse(self, function, vr[0]) : STATUS_OK;
}

int slave_set(Slave *self, const char *function, const Type *type, const uint32_t vr[], size_t n, const void *value) {
    (void)type, (void)value;
    return set_others(self, function, vr, n);
}

int slave_set_strings(Slave *self, const char *function, const uint32_t vr[], size_t n, const char *const value[]) {
    (void)value;
    return set_others(self, function, vr, n);
}
