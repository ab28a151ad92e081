/* Values of variables. */

#include "slave.h"

#include <math.h>
#include <string.h>

static const char *const KIND_NAMES[] = {"real", "integer", "boolean"};
#define READABLE (~IN(INSTANTIATED))
#define SETTABLE (IN(INSTANTIATED) | IN(INITIALIZATION) | IN(STEP_MODE) | IN(INTERMEDIATE) | IN(EVENT_DUE) | IN(EVENT_MODE))

const Variable *slave_variable(const Slave *self, const char *function, uint32_t reference, Kind kind) {
    if (reference < 1 || reference > self->count) {
        slave_error(self, function, "value reference %lu is unknown: this FMU has 1 to %zu, which stand in "
                    "modelDescription.xml", (unsigned long)reference, self->count);
        return NULL;
    }
    const Variable *v = &self->variables[reference - 1];
    if (v->kind != (int32_t)kind) {
        slave_error(self, function, "value reference %lu is of kind %s, not %s: use the functions for that",
                    (unsigned long)reference, v->enumeration ? "enumeration" : KIND_NAMES[v->kind], KIND_NAMES[kind]);
        return NULL;
    }
    return v;
}

/* Have the channels that the run reads at the present time with the present inputs. */
static int look(Slave *self, const char *function) {
    self->asked = true;
    if (self->fresh) {
        return STATUS_OK;
    }
    if (!slave_may(self, function, ~IN(FAILED))) {
        return STATUS_ERROR;
    }
    int status = tlismni_look(self->run);
    if (status) {
        if (self->phase != INITIALIZATION) {
            self->phase = FAILED;
        }
        return slave_run_error(self, function, status);
    }
    self->fresh = true;
    return STATUS_OK;
}

int slave_look_at_all(Slave *self, const char *function) {
    self->fresh = !tlismni_want(self->run, TLISMNI_ALL) && self->fresh;
    return look(self, function);
}

/* Have the run read what a variable shows, now and after the next step. */
static void want(Slave *self, const Variable *v) {
    if (v->source != CHANNEL) {
        return;
    }
    size_t number = (size_t)v->number;
    if (!self->is_wanted[number]) {
        self->is_wanted[number] = true;
        self->wanted[self->wants++] = number;
    }
    self->fresh = !tlismni_want(self->run, number) && self->fresh;
}

void slave_want_what_was_asked(Slave *self) {
    tlismni_want_none(self->run);
    for (size_t k = 0; k < self->wants; k++) {
        tlismni_want(self->run, self->wanted[k]);
        self->is_wanted[self->wanted[k]] = false;
    }
    self->wants = 0;
}

static double value_of(const Slave *self, const Variable *v) {
    switch (v->source) {
    case TIME:
        return tlismni_time(self->run);
    case INPUT:
        return tlismni_inputs(self->run)[v->number];
    case PARAMETER:
        return self->parameters[v->number];
    case CHANNEL:
        return tlismni_channels(self->run)[v->number];
    case EVENT_COUNT:
        return (double)tlismni_event_count(self->run);
    default:
        return v->start;
    }
}

int slave_get_reals(Slave *self, const char *function, const uint32_t vr[], size_t n, double value[]) {
    if (!slave_may(self, function, READABLE) || !slave_has_room(self, function, vr, n) ||
        !slave_has_room(self, function, value, n)) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < n; k++) { /* all of them at once */
        const Variable *v = slave_variable(self, function, vr[k], REAL);
        if (!v) {
            return STATUS_ERROR;
        }
        want(self, v);
    }
    for (size_t k = 0; k < n; k++) {
        const Variable *v = &self->variables[vr[k] - 1];
        if (v->source >= CHANNEL && look(self, function) != STATUS_OK) {
            return STATUS_ERROR;
        }
        value[k] = value_of(self, v);
    }
    return STATUS_OK;
}

int slave_get_wholes(Slave *self, const char *function, Kind kind, int enumerations, const uint32_t vr[], size_t n,
                     int64_t value[]) {
    if (!slave_may(self, function, READABLE) || !slave_has_room(self, function, vr, n) ||
        !slave_has_room(self, function, value, n)) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < n; k++) {
        const Variable *v = slave_variable(self, function, vr[k], kind);
        if (v && enumerations >= 0 && v->enumeration != enumerations) {
            return slave_error(self, function, "value reference %lu is %s: use the functions for %s", (unsigned long)vr[k],
                               enumerations ? "an Int32, no enumeration" : "an enumeration", enumerations ? "Int32" : "Int64");
        }
        if (v) {
            want(self, v);
        }
        if (!v || (v->source >= CHANNEL && look(self, function) != STATUS_OK)) {
            return STATUS_ERROR;
        }
        double number = value_of(self, v);
        value[k] = kind == BOOLEAN ? number != 0.0 : (int64_t)rint(number);
    }
    return STATUS_OK;
}

static int refuse(const Slave *self, const char *function, uint32_t reference) {
    return slave_error(self, function, "value reference %lu cannot be set: it is neither an input nor a parameter that an "
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
        slave_error(self, function, "value reference %lu is a parameter, which is fixed after initialization: reset, then "
                    "set it before", (unsigned long)reference);
        return false;
    }
    if (self->phase == INTERMEDIATE && !among(self->intermediate, self->intermediates, reference)) {
        slave_error(self, function, "in an intermediate update only the required intermediate variables can be set, not value "
                    "reference %lu: name it when the instance is made", (unsigned long)reference);
        return false;
    }
    if (!isfinite(value) || value < v->least || value > v->largest) {
        const char *name = tlismni_name(self->model, v->source == INPUT ? TLISMNI_INPUT : TLISMNI_PARAMETER,
                                        (size_t)v->number);
        slave_error(self, function, "'%s' was set to %g, which is not finite or outside its range [%g, %g]: check what "
                    "feeds it", name ? name : "?", value, v->least, v->largest);
        return false;
    }
    return true;
}

void slave_take_parameters(Slave *self) {
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
        return slave_run_error(self, function, at);
    }
    for (size_t k = 0; k < count; k++) {
        int status = tlismni_set_parameter(self->run, k, self->parameters[k]);
        if (status) {
            return slave_not_set(self, function, k, status);
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

int slave_set_reals(Slave *self, const char *function, const uint32_t vr[], size_t n, const double value[]) {
    if (!slave_may(self, function, SETTABLE) || !slave_has_room(self, function, vr, n) ||
        !slave_has_room(self, function, value, n)) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < n; k++) { /* all of them or none */
        const Variable *v = slave_variable(self, function, vr[k], REAL);
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

int slave_set_rates(Slave *self, const char *function, const uint32_t vr[], size_t n, const int32_t order[],
                    const double value[]) {
    if (!slave_may(self, function, SETTABLE) || !slave_has_room(self, function, vr, n) ||
        !slave_has_room(self, function, order, n) || !slave_has_room(self, function, value, n)) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < n; k++) { /* all of them or none */
        const Variable *v = slave_variable(self, function, vr[k], REAL);
        if (!v) {
            return STATUS_ERROR;
        }
        if (v->source != INPUT || order[k] < 1 || order[k] > 2 || !isfinite(value[k])) {
            return slave_error(self, function, "a derivative %g of order %ld of value reference %lu was given: only inputs take "
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

int slave_set_others(Slave *self, const char *function, const uint32_t vr[], size_t n) {
    if (!slave_may(self, function, SETTABLE) || !slave_has_room(self, function, vr, n)) {
        return STATUS_ERROR;
    }
    return n ? refuse(self, function, vr[0]) : STATUS_OK;
}
