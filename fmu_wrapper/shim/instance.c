#include "instance.h"
#include "location.h"
#include "resources.h"

#include <stdlib.h>
#include <string.h>

#define MAGIC 0x71150001u
#define MESSAGE 4096
#define CAPSULE "tlismni.instance"

void instance_report(const Instance *self, const char *format, ...) {
    char message[MESSAGE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    self->log(self, STATUS_ERROR, "logStatusError", message);
}

/* Report the pending Python exception. With Python's lock, which the host's logger must not find taken. */
static void report_exception(const Instance *self, const char *function) {
    char error[MESSAGE];
    python_error(error, sizeof error);
    void *thread = py.PyEval_SaveThread();
    instance_report(self, "%s: %s", function, error);
    py.PyEval_RestoreThread(thread);
}

/* log(status, category, message), called from Python. */
static PyObject *log_from_python(PyObject *capsule, PyObject *arguments) {
    int status;
    const char *category, *message;
    const Instance *self = py.PyCapsule_GetPointer(capsule, CAPSULE);
    if (!self || !py.PyArg_ParseTuple(arguments, "iss", &status, &category, &message)) {
        return NULL;
    }
    void *thread = py.PyEval_SaveThread();
    self->log(self, status, category, message);
    py.PyEval_RestoreThread(thread);
    return py.Py_BuildValue("");
}

/* update(time, can_return_early), called from Python: the time at which the step shall end, or None. */
static PyObject *update_from_python(PyObject *capsule, PyObject *arguments) {
    double time, end;
    int can_return_early;
    const Instance *self = py.PyCapsule_GetPointer(capsule, CAPSULE);
    if (!self || !py.PyArg_ParseTuple(arguments, "di", &time, &can_return_early)) {
        return NULL;
    }
    end = time;
    void *thread = py.PyEval_SaveThread();
    bool ends = self->update(self, time, can_return_early != 0, &end);
    py.PyEval_RestoreThread(thread);
    return ends ? py.Py_BuildValue("d", end) : py.Py_BuildValue("");
}

static PyMethodDef update_method = {"update", update_from_python, METH_VARARGS, "An intermediate update."};

static PyMethodDef log_method = {"log", log_from_python, METH_VARARGS, "Hand a message to the host's logger."};

/* Run resources/boot.py in a namespace of its own and call its `create`. */
static PyObject *boot(Instance *self, const char *function, const char *source, const char *path,
                      PyObject *arguments) {
    PyObject *result = NULL;
    PyObject *space = py.PyDict_New();
    PyObject *name = py.Py_BuildValue("s", "tlismni_fmu_boot");
    PyObject *code = py.Py_CompileString(source, path, Py_file_input);
    if (space && name && code && arguments) {
        py.PyDict_SetItemString(space, "__builtins__", py.PyEval_GetBuiltins());
        py.PyDict_SetItemString(space, "__name__", name);
        PyObject *ran = py.PyEval_EvalCode(code, space, space);
        PyObject *create = ran ? py.PyDict_GetItemString(space, "create") : NULL;
        result = create ? py.PyObject_CallObject(create, arguments) : NULL;
        py.Py_DecRef(ran);
    }
    if (!result) {
        report_exception(self, function);
    }
    py.Py_DecRef(code);
    py.Py_DecRef(name);
    py.Py_DecRef(space); /* otherwise every instance would leave its namespace behind */
    return result;
}

/* Take what the Python side shares. An FMU may meet a package of another layout: then it goes without. */
static void share(Instance *self) {
    PyObject *answer = instance_ask(self, "share", py.Py_BuildValue("(i)", SHARED_LAYOUT));
    long long address = instance_number(answer, 0);
    if (address) {
        self->step = py.PyObject_GetAttrString(self->calls, "step");
        self->look = py.PyObject_GetAttrString(self->calls, "look");
    }
    if (self->step && self->look) {
        self->shared = (Shared *)(uintptr_t)address;
    }
    py.PyErr_Clear();
}

/* Make the Python side of `self`. */
static bool populate(Instance *self, const Asked *asked, const char *function, const char *token,
                     const char *resources) {
    char message[MESSAGE], path[MESSAGE];
    int gil;
    snprintf(path, sizeof path, "%s/boot.py", resources);
    char *source = resources_read(path);
    if (!source) {
        instance_report(self, "%s: cannot read '%s': the FMU's resources are missing; unzip the FMU completely and "
                        "pass the URI of its resources folder", function, path);
        return false;
    }
    if (!python_start(resources, message, sizeof message)) {
        instance_report(self, "%s: %s", function, message);
    } else if (!python_enter(&gil)) {
        instance_report(self, "%s: Python is shutting down in this process", function);
    } else {
        PyObject *capsule = py.PyCapsule_New(self, CAPSULE, NULL);
        PyObject *log = capsule ? py.PyCFunction_NewEx(&log_method, capsule, NULL) : NULL;
        PyObject *update = self->update ? py.PyCFunction_NewEx(&update_method, capsule, NULL) : py.Py_BuildValue("");
        PyObject *arguments = log && update ? py.Py_BuildValue(
            "(isssiNiiiNN)", asked->interface, self->name, token, resources, (int)asked->logging_on, log,
            (int)asked->event_mode, (int)asked->early_return, (int)python_is_own(), update,
            view_of(asked->intermediate, asked->intermediates, sizeof *asked->intermediate)) : NULL;
        self->calls = boot(self, function, source, path, arguments);
        if (self->calls) {
            share(self);
        }
        py.Py_DecRef(arguments);
        py.Py_DecRef(capsule);
        python_leave(gil);
    }
    free(source);
    return self->calls != NULL;
}

Instance *instance_new(const Instance *model, const Asked *asked, const char *function, const char *name,
                       const char *token, const char *resource_location) {
    Instance *self = malloc(sizeof *self);
    if (!self) {
        return NULL;
    }
    *self = *model;
    self->magic = MAGIC;
    self->calls = self->strings = self->step = self->look = NULL;
    self->shared = NULL;
    self->gets.count = self->sets.count = 0;
    self->name = text_copy(name && *name ? name : "instance");
    char *resources = resource_location ? location_path(resource_location) : NULL;
    bool made = false;
    if (!resources) {
        instance_report(self, "%s: the resource location is NULL: the URI of the FMU's resources folder is needed",
                        function);
    } else if (self->name) {
        made = populate(self, asked, function, token ? token : "", resources);
    }
    free(resources);
    if (!made) {
        instance_free(self);
        return NULL;
    }
    return self;
}

void instance_free(Instance *self) {
    int gil;
    if (!self || self->magic != MAGIC) {
        return;
    }
    if (self->calls && instance_enter(self, &gil)) {
        py.Py_DecRef(instance_call(self, "free", "()"));
        py.Py_DecRef(self->strings);
        py.Py_DecRef(self->step);
        py.Py_DecRef(self->look);
        py.Py_DecRef(self->calls);
        python_leave(gil);
    }
    lists_free(&self->gets);
    lists_free(&self->sets);
    self->magic = 0;
    free(self->name);
    free(self);
}

bool instance_alive(const Instance *self) {
    return self && self->magic == MAGIC;
}

bool instance_enter(Instance *self, int *gil) {
    return instance_alive(self) && python_enter(gil);
}

PyObject *instance_ask(Instance *self, const char *method, PyObject *arguments) {
    PyObject *function = arguments ? py.PyObject_GetAttrString(self->calls, method) : NULL;
    PyObject *answer = function ? py.PyObject_CallObject(function, arguments) : NULL;
    py.Py_DecRef(function);
    py.Py_DecRef(arguments);
    return answer;
}

/* What comes next may need the present time and inputs, and may change what was promised. */
static void settle(Instance *self, bool changes) {
    if (shared_unsettled(self->shared)) {
        PyObject *answer = instance_ask(self, "settle", py.Py_BuildValue("()"));
        if (!answer) {
            report_exception(self, "settle");
        }
        py.Py_DecRef(answer);
    }
    if (changes) {
        shared_forget(self->shared);
    }
}

static PyObject *call(Instance *self, const char *method, const char *format, va_list values) {
    settle(self, strncmp(method + strlen("fmi_"), "Get", 3) != 0);
    PyObject *answer = instance_ask(self, method, py.Py_VaBuildValue(format, values));
    if (!answer) {
        report_exception(self, method);
    }
    return answer;
}

static int status_of(Instance *self, PyObject *answer) {
    int status = (int)instance_number(answer, STATUS_ERROR);
    if (status != STATUS_OK) {
        shared_forget(self->shared);
    }
    return status;
}

PyObject *instance_call(Instance *self, const char *method, const char *format, ...) {
    va_list values;
    va_start(values, format);
    PyObject *answer = call(self, method, format, values);
    va_end(values);
    return answer;
}

int instance_status(Instance *self, const char *method, const char *format, ...) {
    va_list values;
    va_start(values, format);
    PyObject *answer = call(self, method, format, values);
    va_end(values);
    return status_of(self, answer);
}

int instance_invoke(Instance *self, PyObject *method, const char *name) {
    PyObject *answer = py.PyObject_CallNoArgs(method);
    if (!answer) {
        report_exception(self, name);
    }
    return status_of(self, answer);
}

long long instance_number(PyObject *answer, long long otherwise) {
    if (!answer) {
        return otherwise;
    }
    long long number = py.PyLong_AsLongLong(answer);
    if (number == -1 && py.PyErr_Occurred()) {
        py.PyErr_Clear();
        number = otherwise;
    }
    py.Py_DecRef(answer);
    return number;
}

static PyObject *view(void *data, size_t count, size_t size, int access) {
    static char nothing;
    if (count && (!data || count > PTRDIFF_MAX / size)) {
        return py.Py_BuildValue(""); /* the Python side says what is wrong with it */
    }
    return py.PyMemoryView_FromMemory(data ? data : &nothing, (Py_ssize_t)(count * size), access);
}

PyObject *view_of(const void *data, size_t count, size_t size) {
    union {
        const void *given;
        void *taken;
    } pointer = {data}; /* Python's function takes no const; PyBUF_READ keeps the promise */
    return view(pointer.taken, count, size, PyBUF_READ);
}

PyObject *writable_view_of(void *data, size_t count, size_t size) {
    return view(data, count, size, PyBUF_WRITE);
}

PyObject *list_of_strings(const char *const strings[], size_t count) {
    PyObject *list = strings || !count ? py.PyList_New((Py_ssize_t)count) : py.Py_BuildValue("");
    count = strings ? count : 0;
    for (size_t i = 0; list && i < count; i++) {
        PyObject *item = strings[i] ? py.PyBytes_FromString(strings[i]) : py.Py_BuildValue("");
        if (!item || py.PyList_SetItem(list, (Py_ssize_t)i, item) != 0) {
            py.Py_DecRef(list);
            return NULL;
        }
    }
    return list;
}
