/* Values of variables are read. */

#include "native_slave.h"

#include <math.h>

static const char *const KIND_NAMES[] = {"real", "integer", "boolean"};
#define READABLE (~IN(INSTANTIATED))

const Variable *native_variable(const Slave *self, const char *function, uint32_t reference, Kind kind) {
    if (reference < 1 || reference > self->count) {
        native_error(self, function, "value reference %lu is unknown: this FMU has 1 to %zu, which stand in "
                    "modelDescription.xml", (unsigned long)reference, self->count);
        return NULL;
    }
    const Variable *v = &self->variables[reference - 1];
    if (v->kind != (int32_t)kind) {
        native_error(self, function, "value reference %lu is of kind %s, not %s: use the functions for that",
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
    if (!native_may(self, function, ~IN(FAILED))) {
        return STATUS_ERROR;
    }
    int status = tlismni_look(self->run);
    if (status) {
        if (self->phase != INITIALIZATION) {
            self->phase = FAILED;
        }
        return native_run_error(self, function, status);
    }
    self->fresh = true;
    return STATUS_OK;
}

int native_look_at_all(Slave *self, const char *function) {
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

void native_want_what_was_asked(Slave *self) {
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

static int get_reals(Slave *self, const char *function, const uint32_t vr[], size_t n, double value[]) {
    if (!native_may(self, function, READABLE)) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < n; k++) { /* all of them at once */
        const Variable *v = native_variable(self, function, vr[k], REAL);
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

int slave_get_reals(Slave *self, const char *function, const uint32_t vr[], size_t n, double value[], size_t values) {
    Elements e;
    bool found = native_elements(self, function, vr, n, NULL, values, &e);
    int status = found ? get_reals(self, function, e.vr, e.n, value) : STATUS_ERROR;
    native_elements_end(&e);
    return status;
}

/* Write a value of a type, the k-th of an array. */
static void put(void *values, size_t k, const Type *type, double number) {
    if (type->size == sizeof(bool)) {
        ((bool *)values)[k] = number != 0.0;
    } else if (type->size == sizeof(int64_t)) {
        ((int64_t *)values)[k] = (int64_t)rint(number);
    } else {
        ((int32_t *)values)[k] = type->kind == BOOLEAN ? number != 0.0 : (int32_t)rint(number);
    }
}

int slave_get(Slave *self, const char *function, const Type *type, const uint32_t vr[], size_t n, void *value) {
    if (!native_may(self, function, READABLE)) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < n; k++) {
        const Variable *v = native_variable(self, function, vr[k], type->kind);
        if (v && type->enumerations >= 0 && v->enumeration != type->enumerations) {
            return native_error(self, function, "value reference %lu is %s: use the functions for %s", (unsigned long)vr[k],
                                v->enumeration ? "an enumeration" : "an Int32, no enumeration",
                                v->enumeration ? "Int64" : "Int32");
        }
        if (v) {
            want(self, v);
        }
        if (!v || (v->source >= CHANNEL && look(self, function) != STATUS_OK)) {
            return STATUS_ERROR;
        }
        put(value, k, type, value_of(self, v));
    }
    return STATUS_OK;
}

int slave_get_strings(Slave *self, const char *function, const uint32_t vr[], size_t n, const char *value[]) {
    (void)vr, (void)value;
    if (!native_may(self, function, READABLE)) {
        return STATUS_ERROR;
    }
    return n ? native_error(self, function, "this FMU has no strings") : STATUS_OK;
}
