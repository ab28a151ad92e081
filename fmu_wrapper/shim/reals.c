/* What a host calls at every step: get, set and step, in C alone where the answer is known. */
#include "python_slave.h"

/* Ask the Python side where the values of a list are, which it was given a moment ago. With Python's lock. */
static void learn(Slave *self, Lists *lists, const char *method, const unsigned vr[], size_t n) {
    if (!self->shared || lists_full(lists) || lists_find(lists, vr, n)) {
        return;
    }
    PyObject *places = shim_ask(self, method, py.Py_BuildValue("(N)", IN(vr, n)));
    Py_ssize_t size = places ? py.PyBytes_Size(places) : -1;
    if (size >= 0) {
        lists_add(lists, vr, n, py.PyBytes_AsString(places), (size_t)size / sizeof(int32_t));
    }
    py.Py_DecRef(places);
    py.PyErr_Clear();
}

/* The list if it is one whose values are to be answered here. */
static const List *known(Lists *lists, const uint32_t vr[], size_t n, size_t values) {
    const List *list = n ? lists_find(lists, vr, n) : NULL;
    return list && list->values && list->values == values ? list : NULL;
}

int slave_get_reals(Slave *self, const char *function, const uint32_t vr[], size_t n, double value[], size_t values) {
    int gil, status = STATUS_OK;
    const List *list = known(&self->gets, vr, n, values);
    if (list) {
        if (!self->shared->fresh) {
            if (!python_enter(&gil)) {
                return STATUS_ERROR;
            }
            status = shim_invoke(self, self->look, function);
            python_leave(gil);
        }
        if (status == STATUS_OK) {
            shared_read(self->shared, list, value);
        }
        return status;
    }
    if (!python_enter(&gil)) {
        return STATUS_ERROR;
    }
    status = shim_status(self, function, "(NN)", IN(vr, n), OUT(value, values));
    shared_asked(self->shared);
    if (status == STATUS_OK && n) {
        learn(self, &self->gets, "get_places", vr, n);
    }
    python_leave(gil);
    return status;
}

int slave_set_reals(Slave *self, const char *function, const uint32_t vr[], size_t n, const double value[], size_t values) {
    int gil;
    const List *list = known(&self->sets, vr, n, values);
    if (list && self->shared->settable && shared_write(self->shared, list, value)) {
        return STATUS_OK;
    }
    if (!python_enter(&gil)) {
        return STATUS_ERROR;
    }
    int status = shim_status(self, function, "(NN)", IN(vr, n), IN(value, values));
    if (status == STATUS_OK && n) {
        learn(self, &self->sets, "set_places", vr, n);
    }
    python_leave(gil);
    return status;
}

/* A step where the Python side shares nothing. FMI 2.0 does not ask how it ends. */
static int step_by_arguments(Slave *self, const char *function, double t, double h, StepEnd *end) {
    bool terminate;
    if (self->version == 2) {
        end->time = t + h;
        FORWARD(function, "(dd)", t, h);
    }
    FORWARD(function, "(ddNNNN)", t, h, OUT(&end->event_due, 1), OUT(&terminate, 1), OUT(&end->early, 1), OUT(&end->time, 1));
}

int slave_step(Slave *self, const char *function, double t, double h, StepEnd *end) {
    int gil, status = STATUS_OK;
    Shared *shared = self->shared;
    *end = (StepEnd){t, false, false};
    if (!shared) {
        return step_by_arguments(self, function, t, h, end);
    }
    shared->event_due = shared->early = 0;
    if (shared_glide(shared, t, h)) {
        shared->reached = shared->time;
    } else {
        status = STATUS_ERROR;
        if (python_enter(&gil)) {
            shared_forget(shared);
            shared->point = t;
            shared->step = h;
            status = shim_invoke(self, self->step, function);
            python_leave(gil);
        }
    }
    *end = (StepEnd){shared->reached, shared->event_due != 0, shared->early != 0};
    return status;
}
