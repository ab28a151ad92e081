/* What a host calls at every step: get, set and step, in C alone where the answer is known. */
#include "forward.h"

/* Ask the Python side where the values of a list are, which it was given a moment ago. With Python's lock. */
static void learn(Instance *c, Lists *lists, const char *method, const unsigned vr[], size_t n) {
    if (!c->shared || lists_full(lists) || lists_find(lists, vr, n)) {
        return;
    }
    PyObject *places = instance_ask(c, method, py.Py_BuildValue("(N)", IN(vr, n)));
    Py_ssize_t size = places ? py.PyBytes_Size(places) : -1;
    if (size >= 0) {
        lists_add(lists, vr, n, py.PyBytes_AsString(places), (size_t)size / sizeof(int32_t));
    }
    py.Py_DecRef(places);
    py.PyErr_Clear();
}

/* The list if it is one whose values are to be answered here. */
static const List *known(Lists *lists, const unsigned vr[], size_t n, const double value[], size_t values) {
    const List *list = vr && value && n ? lists_find(lists, vr, n) : NULL;
    return list && list->values && list->values == values ? list : NULL;
}

int forward_get_reals(Instance *c, const char *method, const unsigned vr[], size_t n, double value[], size_t values) {
    int gil, status = STATUS_OK;
    const List *list = instance_alive(c) ? known(&c->gets, vr, n, value, values) : NULL;
    if (list) {
        if (!c->shared->fresh) {
            if (!instance_enter(c, &gil)) {
                return STATUS_ERROR;
            }
            status = instance_invoke(c, c->look, method);
            python_leave(gil);
        }
        if (status == STATUS_OK) {
            shared_read(c->shared, list, value);
        }
        return status;
    }
    if (!instance_enter(c, &gil)) {
        return STATUS_ERROR;
    }
    status = instance_status(c, method, "(NN)", IN(vr, n), OUT(value, values));
    shared_asked(c->shared);
    if (status == STATUS_OK && vr && n) {
        learn(c, &c->gets, "get_places", vr, n);
    }
    python_leave(gil);
    return status;
}

int forward_set_reals(Instance *c, const char *method, const unsigned vr[], size_t n, const double value[],
                      size_t values) {
    int gil;
    const List *list = instance_alive(c) ? known(&c->sets, vr, n, value, values) : NULL;
    if (list && c->shared->settable && shared_write(c->shared, list, value)) {
        return STATUS_OK;
    }
    if (!instance_enter(c, &gil)) {
        return STATUS_ERROR;
    }
    int status = instance_status(c, method, "(NN)", IN(vr, n), IN(value, values));
    if (status == STATUS_OK && vr && n) {
        learn(c, &c->sets, "set_places", vr, n);
    }
    python_leave(gil);
    return status;
}

const Shared *forward_step(Instance *c, const char *method, double time, double step, int *status) {
    int gil;
    if (!instance_alive(c) || !c->shared) {
        return NULL;
    }
    *status = STATUS_OK;
    if (shared_glide(c->shared, time, step)) {
        c->shared->reached = c->shared->time;
        c->shared->event_due = c->shared->early = 0;
        return c->shared;
    }
    *status = STATUS_ERROR;
    if (instance_enter(c, &gil)) {
        shared_forget(c->shared);
        c->shared->event_due = c->shared->early = 0;
        c->shared->point = time;
        c->shared->step = step;
        *status = instance_invoke(c, c->step, method);
        python_leave(gil);
    }
    return c->shared;
}
