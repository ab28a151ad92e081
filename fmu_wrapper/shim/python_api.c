#include "python_api.h"
#include "find_python.h"

#include <stdlib.h>
#include <string.h>

PythonApi py;

#define OWN "_tlismni_started" /* in `sys`, where the libraries of other FMUs find it */

static bool ready;
static _Thread_local bool thread_known;

static bool find_functions(void *library, char *message, size_t size) {
    void *address;
#define FIND(result, name, arguments)                                                         \
    address = platform_symbol(library, #name);                                                \
    if (!address) {                                                                           \
        snprintf(message, size, "the Python library lacks " #name ": Python 3.11 or newer is needed"); \
        return false;                                                                         \
    }                                                                                         \
    memcpy(&py.name, &address, sizeof address);
    PYTHON_FUNCTIONS(FIND)
#undef FIND
    return true;
}

/* Start the interpreter in this process, whose main program is no Python.
 * Without a home Python looks for one beside the first python3 in PATH, which may be another Python; and a wrong home
 * ends the process (Py_FatalError), so it is looked at first. */
static bool initialize(FoundPython *found, char *message, size_t size) {
    bool set_home = !getenv("PYTHONHOME");
    if (set_home && !python_home(found, py.Py_GetVersion(), message, size)) {
        return false;
    }
    if (set_home) {
        platform_setenv("PYTHONHOME", found->home);
    }
    py.Py_InitializeEx(0); /* 0: the host's signal handlers stay */
    if (set_home) {
        platform_setenv("PYTHONHOME", NULL); /* not for programs that the host starts */
    }
    PyObject *yes = py.Py_BuildValue("i", 1);
    py.PySys_SetObject(OWN, yes);
    py.Py_DecRef(yes);
    py.PyEval_SaveThread(); /* this thread keeps its Python state, but not the lock */
    thread_known = true;
    return true;
}

static bool start(const char *resources, char *message, size_t size) {
    FoundPython found;
    if (!find_python(resources, &found, message, size) || !find_functions(found.library, message, size)) {
        return false;
    }
    platform_lock_process();
    bool running = py.Py_IsInitialized() || initialize(&found, message, size);
    platform_unlock_process();
    if (running) {
        platform_pin();
    }
    return running;
}

bool python_is_own(void) {
    return py.PySys_GetObject(OWN) != NULL;
}

bool python_start(const char *resources, char *message, size_t size) {
    platform_lock();
    if (!ready) {
        ready = start(resources, message, size);
    }
    platform_unlock();
    return ready;
}

bool python_enter(int *gil) {
    if (!ready || !py.Py_IsInitialized()) {
        return false;
    }
    if (!thread_known) {
        /* One Ensure that is never released keeps the thread's Python state: since Python 3.11 each Ensure and
         * Release of a foreign thread would otherwise build and destroy one, ten times the cost of a call. */
        int first = py.PyGILState_Ensure();
        if (first == PyGILState_UNLOCKED) {
            py.PyEval_SaveThread();
        } else {
            py.PyGILState_Release(first); /* the thread holds the lock already: it has its own state */
        }
        thread_known = true;
    }
    *gil = py.PyGILState_Ensure();
    return true;
}

void python_leave(int gil) {
    py.PyGILState_Release(gil);
}

/* Append the text of `object`, or of its attribute `name`. */
static void append(char *message, size_t size, PyObject *object, const char *name) {
    PyObject *value = name ? py.PyObject_GetAttrString(object, name) : NULL;
    PyObject *text = value || !name ? py.PyObject_Str(value ? value : object) : NULL;
    PyObject *bytes = text ? py.PyUnicode_AsUTF8String(text) : NULL;
    size_t used = strlen(message);
    snprintf(message + used, size - used, "%s", bytes ? py.PyBytes_AsString(bytes) : "?");
    py.Py_DecRef(bytes);
    py.Py_DecRef(text);
    py.Py_DecRef(value);
    py.PyErr_Clear();
}

void python_error(char *message, size_t size) {
    PyObject *type = NULL, *value = NULL, *trace = NULL;
    py.PyErr_Fetch(&type, &value, &trace);
    py.PyErr_NormalizeException(&type, &value, &trace);
    message[0] = '\0';
    if (type) {
        append(message, size, type, "__name__");
    }
    if (value) {
        size_t used = strlen(message);
        snprintf(message + used, size - used, ": ");
        append(message, size, value, NULL);
    }
    py.Py_DecRef(type);
    py.Py_DecRef(value);
    py.Py_DecRef(trace);
}
