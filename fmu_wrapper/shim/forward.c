#include "forward.h"

bool forward_has_room(const Instance *c, const char *method, const void *room) {
    if (!room && instance_alive(c)) {
        instance_report(c, "%s: FmuValueError: NULL was given for what the call answers with: pass the address of a "
                        "variable", method);
    }
    return room != NULL;
}

int forward_get_strings(Instance *c, const char *method, const unsigned vr[], size_t n, const char *value[]) {
    int gil, status = STATUS_ERROR;
    if ((n && !forward_has_room(c, method, value)) || !instance_enter(c, &gil)) {
        return STATUS_ERROR;
    }
    PyObject *strings = instance_call(c, method, "(N)", IN(vr, n));
    if (strings && n <= PTRDIFF_MAX && py.PyList_Size(strings) == (Py_ssize_t)n) {
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
    if (!forward_has_room(c, method, state) || !instance_enter(c, &gil)) {
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
    if (!forward_has_room(c, method, size) || !instance_enter(c, &gil)) {
        return STATUS_ERROR;
    }
    long long bytes = instance_number(instance_call(c, method, "(K)", HANDLE(state)), -1);
    python_leave(gil);
    *size = bytes < 0 ? 0 : (size_t)bytes;
    return bytes < 0 ? STATUS_ERROR : STATUS_OK;
}

int forward_read_state(Instance *c, const char *method, const void *bytes, size_t size, void **state) {
    int gil;
    if (!forward_has_room(c, method, state) || !instance_enter(c, &gil)) {
        return STATUS_ERROR;
    }
    PyObject *answer = instance_call(c, method, "(NK)", view_of(bytes, size, 1), HANDLE(*state));
    int status = store_handle(answer, state);
    python_leave(gil);
    return status;
}
