#include "forward.h"

int forward_get_strings(Instance *c, const char *method, const unsigned vr[], size_t n, const char *value[]) {
    int gil, status = STATUS_ERROR;
    if (!instance_enter(c, &gil)) {
        return STATUS_ERROR;
    }
    PyObject *strings = instance_call(c, method, "(N)", IN(vr, n));
    if (strings && py.PyList_Size(strings) == (Py_ssize_t)n) {
        for (size_t i = 0; i < n; i++) {
            value[i] = py.PyBytes_AsString(py.PyList_GetItem(strings, (Py_ssize_t)i));
        }
        status = STATUS_OK;
    }
    py.PyErr_Clear(); /* PyList_Size complains about the None of an error that was logged */
    py.Py_DecRef(c->strings);
    c->strings = strings;
    python_leave(gil);
    return status;
}

/* Store the handle that a call answered with. */
static int store_handle(PyObject *answer, void **state) {
    long long handle = instance_number(answer, 0);
    if (handle) {
        *state = (void *)(uintptr_t)handle;
    }
    return handle ? STATUS_OK : STATUS_ERROR;
}

int forward_get_state(Instance *c, const char *method, void **state) {
    int gil;
    if (!instance_enter(c, &gil)) {
        return STATUS_ERROR;
    }
    int status = store_handle(instance_call(c, method, "(K)", HANDLE(*state)), state);
    python_leave(gil);
    return status;
}

int forward_free_state(Instance *c, const char *method, void **state) {
    void *handle = state ? *state : NULL;
    if (!handle) {
        return STATUS_OK;
    }
    *state = NULL;
    FORWARD(c, method, "(K)", HANDLE(handle));
}

int forward_state_size(Instance *c, const char *method, void *state, size_t *size) {
    int gil;
    if (!instance_enter(c, &gil)) {
        return STATUS_ERROR;
    }
    long long bytes = instance_number(instance_call(c, method, "(K)", HANDLE(state)), -1);
    python_leave(gil);
    *size = bytes < 0 ? 0 : (size_t)bytes;
    return bytes < 0 ? STATUS_ERROR : STATUS_OK;
}

int forward_read_state(Instance *c, const char *method, const void *bytes, size_t size, void **state) {
    int gil;
    if (!instance_enter(c, &gil)) {
        return STATUS_ERROR;
    }
    PyObject *answer = instance_call(c, method, "(NK)", view_of(bytes, size), HANDLE(*state));
    int status = store_handle(answer, state);
    python_leave(gil);
    return status;
}
