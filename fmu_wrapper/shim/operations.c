/* The calls of an instance but those of each step (reals.c): handed to the methods of the same names in Python, which say what
 * is allowed when. */

#include "python_slave.h"

/* A stored state is a number to the host, not an address. */
#define HANDLE(state) ((unsigned long long)(uintptr_t)(state))
#define VALUES Slave *self, const char *function, const uint32_t vr[], size_t n

/* A list of bytes objects, None for NULL. */
static PyObject *list_of_strings(const char *const strings[], size_t count) {
    PyObject *list = py.PyList_New((Py_ssize_t)count);
    for (size_t i = 0; list && i < count; i++) {
        PyObject *item = strings[i] ? py.PyBytes_FromString(strings[i]) : py.Py_BuildValue("");
        if (!item || py.PyList_SetItem(list, (Py_ssize_t)i, item) != 0) {
            py.Py_DecRef(list);
            return NULL;
        }
    }
    return list;
}

int slave_log_chosen(Slave *self, const char *function, bool on, const char *const categories[], size_t count) {
    FORWARD(function, "(iN)", (int)on, list_of_strings(categories, count));
}

/* life */

int slave_set_up(Slave *self, const char *function, const Experiment *e) {
    FORWARD(function, "(iddid)", (int)e->tolerance_defined, e->tolerance, e->start, (int)e->stop_defined, e->stop);
}

int slave_enter_initialization(Slave *self, const char *function, const Experiment *experiment) {
    if (experiment) {
        return slave_set_up(self, function, experiment); /* the method does both */
    }
    FORWARD(function, "()");
}

int slave_exit_initialization(Slave *self, const char *function) {
    FORWARD(function, "()");
}

int slave_terminate(Slave *self, const char *function) {
    FORWARD(function, "()");
}

int slave_reset(Slave *self, const char *function) {
    FORWARD(function, "()");
}

/* events */

int slave_enter_event_mode(Slave *self, const char *function) {
    FORWARD(function, "()");
}

int slave_update(Slave *self, const char *function, bool *again) {
    bool terminate, nominals_changed, values_changed, next_event_defined;
    double next_event;
    FORWARD(function, "(NNNNNN)", OUT(again, 1), OUT(&terminate, 1), OUT(&nominals_changed, 1), OUT(&values_changed, 1),
            OUT(&next_event_defined, 1), OUT(&next_event, 1));
}

int slave_enter_step_mode(Slave *self, const char *function) {
    FORWARD(function, "()");
}

/* The method that FMI 2.0 has for it answers for the last step. */
int slave_time(Slave *self, const char *function, double *time) {
    enum { LAST_SUCCESSFUL_TIME = 2 };
    FORWARD(function, "(iN)", LAST_SUCCESSFUL_TIME, OUT(time, 1));
}

/* values */

int slave_get(Slave *self, const char *function, const Type *type, const uint32_t vr[], size_t n, void *value) {
    FORWARD(function, "(NN)", IN(vr, n), shim_writable_view(value, n, type->size));
}

int slave_set(Slave *self, const char *function, const Type *type, const uint32_t vr[], size_t n, const void *value) {
    FORWARD(function, "(NN)", IN(vr, n), shim_view(value, n, type->size));
}

int slave_get_strings(VALUES, const char *value[]) {
    int gil, status = STATUS_ERROR;
    if (!python_enter(&gil)) {
        return STATUS_ERROR;
    }
    PyObject *strings = shim_call(self, function, "(N)", IN(vr, n));
    if (strings && py.PyList_Size(strings) == (Py_ssize_t)n) {
        for (size_t i = 0; i < n; i++) {
            value[i] = py.PyBytes_AsString(py.PyList_GetItem(strings, (Py_ssize_t)i));
        }
        status = STATUS_OK;
    }
    py.PyErr_Clear(); /* PyList_Size complains about the None of an error that was logged */
    py.Py_DecRef(self->strings);
    self->strings = strings;
    python_leave(gil);
    return status;
}

int slave_set_strings(VALUES, const char *const value[]) {
    FORWARD(function, "(NN)", IN(vr, n), list_of_strings(value, n));
}

/* derivatives */

int slave_directional(Slave *self, const char *function, const Question *q) {
    FORWARD(function, "(NNNN)", IN(q->unknown, q->unknowns), IN(q->known, q->knowns), IN(q->seed, q->seeds),
            OUT(q->sensitivity, q->sensitivities));
}

int slave_adjoint(Slave *self, const char *function, const Question *q) {
    return slave_directional(self, function, q); /* another method, with the same arguments */
}

int slave_output_derivatives(VALUES, const int32_t order[], double value[], size_t values) {
    FORWARD(function, "(NNN)", IN(vr, n), IN(order, n), OUT(value, values));
}

int slave_set_rates(VALUES, const int32_t order[], const double value[]) {
    FORWARD(function, "(NNN)", IN(vr, n), IN(order, n), IN(value, n));
}

/* stored states */

/* Store the handle that a call answered with. */
static int store_handle(PyObject *answer, void **state) {
    long long handle = shim_number(answer, 0);
    if (handle) {
        *state = (void *)(uintptr_t)handle;
    }
    return handle ? STATUS_OK : STATUS_ERROR;
}

int slave_get_state(Slave *self, const char *function, void **state) {
    int gil;
    if (!python_enter(&gil)) {
        return STATUS_ERROR;
    }
    int status = store_handle(shim_call(self, function, "(K)", HANDLE(*state)), state);
    python_leave(gil);
    return status;
}

int slave_set_state(Slave *self, const char *function, void *state) {
    FORWARD(function, "(K)", HANDLE(state));
}

int slave_free_state(Slave *self, const char *function, void *state) {
    FORWARD(function, "(K)", HANDLE(state));
}

int slave_state_size(Slave *self, const char *function, void *state, size_t *size) {
    int gil;
    if (!python_enter(&gil)) {
        return STATUS_ERROR;
    }
    long long bytes = shim_number(shim_call(self, function, "(K)", HANDLE(state)), -1);
    python_leave(gil);
    *size = bytes < 0 ? 0 : (size_t)bytes;
    return bytes < 0 ? STATUS_ERROR : STATUS_OK;
}

int slave_write_state(Slave *self, const char *function, void *state, void *bytes, size_t size) {
    FORWARD(function, "(KN)", HANDLE(state), shim_writable_view(bytes, size, 1));
}

int slave_read_state(Slave *self, const char *function, const void *bytes, size_t size, void **state) {
    int gil;
    if (!python_enter(&gil)) {
        return STATUS_ERROR;
    }
    int status = store_handle(shim_call(self, function, "(NK)", shim_view(bytes, size, 1), HANDLE(*state)), state);
    python_leave(gil);
    return status;
}
