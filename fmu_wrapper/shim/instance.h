/* An FMU instance: the Python object that answers its calls, and the host's logger. */
#ifndef TLISMNI_INSTANCE_H
#define TLISMNI_INSTANCE_H

#include "python_api.h"
#include "shared.h"

/* Status numbers of FMI 2.0 and 3.0. */
typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL } Status;

typedef struct Instance Instance;

/* Hands one message to the host, in the manner of the instance's FMI version. */
typedef void (*HostLogger)(const Instance *, int status, const char *category, const char *message);

/* Intermediate update (FMI 3.0) at `time`: true if the host wants the step to end at `*end`. */
typedef bool (*HostUpdate)(const Instance *, double time, bool can_return_early, double *end);

struct Instance {
    unsigned magic;
    PyObject *calls;    /* Fmi2Calls or Fmi3Calls */
    PyObject *strings;  /* list of bytes that the last "get string" gave: the host holds pointers into them */
    HostLogger log;
    void (*logger)(void); /* the host's callback, of the type that `log` knows; NULL for none */
    HostUpdate update;     /* NULL: the host wants no intermediate updates */
    void (*updater)(void); /* the host's callback, of the type that `update` knows */
    void *environment;
    char *name;
    Shared *shared; /* NULL: the Python side is of a version that shares nothing */
    PyObject *step, *look; /* methods of `calls` that need no arguments */
    Lists gets, sets;
};

/* What the host asks of a new instance; the event mode and all behind it are FMI 3.0's. */
typedef struct {
    int interface; /* FMI major version */
    bool logging_on, event_mode, early_return;
    const unsigned *intermediate; /* value references of the inputs that are set in intermediate updates */
    size_t intermediates;
} Asked;

/* A new instance, or NULL with a line in the host's log. Takes over nothing; `model` is filled in by the caller
 * with `log`, `logger`, `update`, `updater`, `environment` and is copied. */
Instance *instance_new(const Instance *model, const Asked *asked, const char *function, const char *name,
                       const char *token, const char *resource_location);

/* Free an instance; NULL is allowed. */
void instance_free(Instance *self);

/* Whether `self` is an instance. */
bool instance_alive(const Instance *self);

/* Take Python's lock for a call on `self`. False, with nothing taken, if `self` is no instance or Python is gone. */
bool instance_enter(Instance *self, int *gil);

/* Log an error of the shim itself. Without Python's lock. */
void instance_report(const Instance *self, const char *format, ...) PRINTF_LIKE(2, 3);

/* Call a method with a tuple of arguments, which is taken over, and nothing else. NULL with a pending exception. */
PyObject *instance_ask(Instance *self, const char *method, PyObject *arguments);

/* Call a method; `format` builds its arguments as in Py_BuildValue. NULL after an exception, which was logged. */
PyObject *instance_call(Instance *self, const char *method, const char *format, ...);

/* The same for a method that answers with a status. */
int instance_status(Instance *self, const char *method, const char *format, ...);

/* The status that `method` of the name `name` answers with. It takes no arguments and looks at what is shared itself. */
int instance_invoke(Instance *self, PyObject *method, const char *name);

/* A number that a method answered with; `otherwise` if it is none. Takes over the reference. */
long long instance_number(PyObject *answer, long long otherwise);

/* Memory views on arrays, for the time of a call; None for NULL where `count` says that there is something. */
PyObject *view_of(const void *data, size_t count, size_t size);
PyObject *writable_view_of(void *data, size_t count, size_t size);

/* A list of bytes objects (None for NULL); None for NULL where `count` says that there is something. */
PyObject *list_of_strings(const char *const strings[], size_t count);

#endif
