/* The instance of an FMU that runs with Python: the Python object that answers its calls, whose methods have the names of the
 * functions of FMI (`Fmi2Calls`, `Fmi3Calls`). */
#ifndef TLISMNI_PYTHON_SLAVE_H
#define TLISMNI_PYTHON_SLAVE_H

#include "../fmi/slave.h"
#include "python_api.h"
#include "shared.h"

struct Slave {
    unsigned magic;
    Host host;
    int version;       /* of FMI */
    PyObject *calls;   /* Fmi2Calls or Fmi3Calls */
    PyObject *strings; /* list of bytes that the last "get string" gave: the host holds pointers into them */
    Shared *shared; /* NULL: the Python side is of a version that shares nothing */
    PyObject *step, *look; /* methods of `calls` that need no arguments */
    Lists gets, sets;
};

/* Return the status of a method of `self`, whose arguments are made with Python's lock. */
#define FORWARD(...)                                      \
    do {                                                  \
        int gil;                                          \
        if (!python_enter(&gil)) {                        \
            return STATUS_ERROR;                          \
        }                                                 \
        int status = shim_status(self, __VA_ARGS__);      \
        python_leave(gil);                                \
        return status;                                    \
    } while (0)

#define IN(array, count) shim_view(array, count, sizeof *(array))
#define OUT(array, count) shim_writable_view(array, count, sizeof *(array))

/* Call a method with a tuple of arguments, which is taken over, and nothing else. NULL with a pending exception. */
PyObject *shim_ask(Slave *self, const char *method, PyObject *arguments);

/* Call a method; `format` builds its arguments as in Py_BuildValue. NULL after an exception, which was logged. */
PyObject *shim_call(Slave *self, const char *method, const char *format, ...);

/* The same for a method that answers with a status. */
int shim_status(Slave *self, const char *method, const char *format, ...);

/* The status that `method` of the name `name` answers with. It takes no arguments and looks at what is shared itself. */
int shim_invoke(Slave *self, PyObject *method, const char *name);

/* A number that a method answered with; `otherwise` if it is none. Takes over the reference. */
long long shim_number(PyObject *answer, long long otherwise);

/* Memory views on arrays, for the time of a call. */
PyObject *shim_view(const void *data, size_t count, size_t size);
PyObject *shim_writable_view(void *data, size_t count, size_t size);

#endif
