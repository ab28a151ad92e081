#include "python_api.h"

#include <stdlib.h>
#include <string.h>

#define LINE 4096

PythonApi py;

static bool ready;
static _Thread_local bool thread_known;

/* What the export recorded of its Python, a line each: shared library, home, a file of its standard library. */
typedef struct {
    char library[LINE];
    char home[LINE];
    char landmark[LINE];
} Record;

static void read_line(FILE *file, char *line) {
    line[0] = '\0';
    if (fgets(line, LINE, file)) {
        line[strcspn(line, "\r\n")] = '\0';
    }
}

static void read_record(const char *resources, Record *record) {
    char path[LINE + 32];
    memset(record, 0, sizeof *record);
    snprintf(path, sizeof path, "%s/libpython.txt", resources);
    FILE *file = platform_open(path);
    if (file) {
        read_line(file, record->library);
        read_line(file, record->home);
        read_line(file, record->landmark);
        fclose(file);
    }
}

static bool can_read(const char *path) {
    FILE *file = platform_open(path);
    if (file) {
        fclose(file);
    }
    return file != NULL;
}

/* Load the library of one of the usual names. */
static bool load_usual(void **library) {
    static const char *const patterns[] = {
#if defined _WIN32
        "python3%d.dll",
#elif defined __APPLE__
        "libpython3.%d.dylib",
#else
        "libpython3.%d.so.1.0",
        "libpython3.%d.so",
#endif
    };
    char name[64];
    for (int minor = 20; minor >= 11; minor--) {
        for (size_t i = 0; i < sizeof patterns / sizeof *patterns; i++) {
            snprintf(name, sizeof name, patterns[i], minor);
            *library = platform_load(name);
            if (*library) {
                return true;
            }
        }
    }
    return false;
}

/* Find the library that has Python: in the process, by the environment, as recorded, by the usual names.
 * `recorded` tells whether it is the recorded one, so that the recorded home belongs to it. */
static bool find_library(const Record *record, void **library, bool *recorded, char *message, size_t size) {
    *recorded = false;
    if (platform_loaded_python(library)) {
        return true;
    }
    const char *chosen = getenv("TLISMNI_LIBPYTHON");
    if (chosen && *chosen) {
        *library = platform_load(chosen);
        if (!*library) {
            snprintf(message, size, "TLISMNI_LIBPYTHON names '%s', which cannot be loaded: %s; correct or unset it",
                     chosen, platform_load_error());
        }
        return *library != NULL;
    }
    char cause[512] = "none was recorded in resources/libpython.txt";
    if (record->library[0]) {
        *library = platform_load(record->library);
        if (*library) {
            *recorded = true;
            return true;
        }
        snprintf(cause, sizeof cause, "the recorded one failed: %s", platform_load_error());
    }
    if (load_usual(library)) {
        return true;
    }
    snprintf(message, size,
             "no Python library found: %s; libpython3.11 to 3.20 are not on the system's path either. Install the "
             "Python that the FMU was exported with, or set the environment variable TLISMNI_LIBPYTHON to the path "
             "of a libpython3.x that has tlismni",
             cause);
    return false;
}

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

/* Start the interpreter in this process, whose main program is no Python. */
static bool initialize(const Record *record, bool recorded, char *message, size_t size) {
    /* Without a home Python looks for one beside the first python3 in PATH, which may be another Python.
     * A wrong home ends the process (Py_FatalError), so look first. */
    bool set_home = recorded && record->home[0] && !getenv("PYTHONHOME");
    if (set_home && !can_read(record->landmark)) {
        snprintf(message, size, "the Python that the FMU was exported with is incomplete: '%s' cannot be read; "
                 "repair it, or set TLISMNI_LIBPYTHON and PYTHONHOME to another one", record->landmark);
        return false;
    }
    if (set_home) {
        platform_setenv("PYTHONHOME", record->home);
    }
    py.Py_InitializeEx(0); /* 0: the host's signal handlers stay */
    if (set_home) {
        platform_setenv("PYTHONHOME", NULL); /* not for programs that the host starts */
    }
    py.PyEval_SaveThread(); /* this thread keeps its Python state, but not the lock */
    thread_known = true;
    return true;
}

static bool start(const char *resources, char *message, size_t size) {
    Record record;
    void *library;
    bool recorded;
    read_record(resources, &record);
    if (!find_library(&record, &library, &recorded, message, size) || !find_functions(library, message, size)) {
        return false;
    }
    if (!py.Py_IsInitialized() && !initialize(&record, recorded, message, size)) {
        return false;
    }
    platform_pin();
    return true;
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
