#include "python_slave.h"

#include <stdlib.h>
#include <string.h>

#include "../fmi/files.h"

#define MAGIC 0x71150001u
#define MESSAGE 4096
#define CAPSULE "tlismni.instance"

/* Report the pending Python exception. With Python's lock, which the host's logger must not find taken. */
static void report_exception(const Slave *self, const char *function) {
    char error[MESSAGE];
    python_error(error, sizeof error);
    void *thread = py.PyEval_SaveThread();
    host_error(&self->host, function, "%s", error);
    py.PyEval_RestoreThread(thread);
}

/* log(status, category, message), called from Python. */
static PyObject *log_from_python(PyObject *capsule, PyObject *arguments) {
    int status;
    const char *category, *message;
    Slave *self = py.PyCapsule_GetPointer(capsule, CAPSULE);
    if (!self || !py.PyArg_ParseTuple(arguments, "iss", &status, &category, &message)) {
        return NULL;
    }
    void *thread = py.PyEval_SaveThread();
    self->host.log(&self->host, status, category, message);
    py.PyEval_RestoreThread(thread);
    return py.Py_BuildValue("");
}

/* update(time, can_return_early), called from Python: the time at which the step shall end, or None. */
static PyObject *update_from_python(PyObject *capsule, PyObject *arguments) {
    double time, end;
    int can_return_early;
    Slave *self = py.PyCapsule_GetPointer(capsule, CAPSULE);
    if (!self || !py.PyArg_ParseTuple(arguments, "di", &time, &can_return_early)) {
        return NULL;
    }
    end = time;
    void *thread = py.PyEval_SaveThread();
    bool ends = self->host.update(&self->host, time, can_return_early != 0, &end);
    py.PyEval_RestoreThread(thread);
    return ends ? py.Py_BuildValue("d", end) : py.Py_BuildValue("");
}

static PyMethodDef update_method = {"update", update_from_python, METH_VARARGS, "An intermediate update."};

static PyMethodDef log_method = {"log", log_from_python, METH_VARARGS, "Hand a message to the host's logger."};

/* Run resources/boot.py in a namespace of its own and call its `create`. */
static PyObject *boot(Slave *self, const char *function, const char *source, const char *path,
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
static void share(Slave *self) {
    PyObject *answer = shim_ask(self, "share", py.Py_BuildValue("(i)", SHARED_LAYOUT));
    long long address = shim_number(answer, 0);
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
static bool populate(Slave *self, const Asked *asked, const char *function, const char *token, const char *resources) {
    char message[MESSAGE], path[MESSAGE];
    int gil;
    snprintf(path, sizeof path, "%s/boot.py", resources);
    char *source = files_read(path, NULL);
    if (!source) {
        host_error(&self->host, function, "cannot read '%s': the FMU's resources are missing; unzip the FMU completely and "
                   "pass the URI of its resources folder", path);
        return false;
    }
    if (!python_start(resources, message, sizeof message)) {
        host_error(&self->host, function, "%s", message);
    } else if (!python_enter(&gil)) {
        host_error(&self->host, function, "Python is shutting down in this process");
    } else {
        PyObject *capsule = py.PyCapsule_New(self, CAPSULE, NULL);
        PyObject *log = capsule ? py.PyCFunction_NewEx(&log_method, capsule, NULL) : NULL;
        PyObject *update = self->host.update ? py.PyCFunction_NewEx(&update_method, capsule, NULL) : py.Py_BuildValue("");
        PyObject *arguments = log && update ? py.Py_BuildValue(
            "(isssiNiiiNN)", asked->version, self->host.name, token, resources, (int)asked->logging_on, log,
            (int)asked->event_mode, (int)asked->early_return, (int)python_is_own(), update,
            shim_view(asked->intermediate, asked->intermediates, sizeof *asked->intermediate)) : NULL;
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

Slave *slave_new(const Host *host, const Asked *asked, const char *function, const char *token, const char *resources) {
    Slave *self = calloc(1, sizeof *self);
    if (!self) {
        return NULL;
    }
    self->magic = MAGIC;
    self->host = *host;
    self->version = asked->version;
    if (!populate(self, asked, function, token, resources)) {
        slave_free(self);
        return NULL;
    }
    return self;
}

void slave_free(Slave *self) {
    int gil;
    if (self->calls && python_enter(&gil)) {
        py.Py_DecRef(shim_call(self, "free", "()"));
        py.Py_DecRef(self->strings);
        py.Py_DecRef(self->step);
        py.Py_DecRef(self->look);
        py.Py_DecRef(self->calls);
        python_leave(gil);
    }
    lists_free(&self->gets);
    lists_free(&self->sets);
    self->magic = 0;
    free(self);
}

Host *slave_host(const Slave *self) {
    Slave *instance = (Slave *)(uintptr_t)self; /* what is shown of it may change */
    return self && self->magic == MAGIC ? &instance->host : NULL;
}

PyObject *shim_ask(Slave *self, const char *method, PyObject *arguments) {
    PyObject *function = arguments ? py.PyObject_GetAttrString(self->calls, method) : NULL;
    PyObject *answer = function ? py.PyObject_CallObject(function, arguments) : NULL;
    py.Py_DecRef(function);
    py.Py_DecRef(arguments);
    return answer;
}

/* What comes next may need the present time and inputs, and may change what was promised. */
static void settle(Slave *self, bool changes) {
    if (shared_unsettled(self->shared)) {
        PyObject *answer = shim_ask(self, "settle", py.Py_BuildValue("()"));
        if (!answer) {
            report_exception(self, "settle");
        }
        py.Py_DecRef(answer);
    }
    if (changes) {
        shared_forget(self->shared);
    }
}

static PyObject *call(Slave *self, const char *method, const char *format, va_list values) {
    settle(self, strncmp(method + strlen("fmi_"), "Get", 3) != 0);
    PyObject *answer = shim_ask(self, method, py.Py_VaBuildValue(format, values));
    if (!answer) {
        report_exception(self, method);
    }
    return answer;
}

static int status_of(Slave *self, PyObject *answer) {
    int status = (int)shim_number(answer, STATUS_ERROR);
    if (status != STATUS_OK) {
        shared_forget(self->shared);
    }
    return status;
}

PyObject *shim_call(Slave *self, const char *method, const char *format, ...) {
    va_list values;
    va_start(values, format);
    PyObject *answer = call(self, method, format, values);
    va_end(values);
    return answer;
}

int shim_status(Slave *self, const char *method, const char *format, ...) {
    va_list values;
    va_start(values, format);
    PyObject *answer = call(self, method, format, values);
    va_end(values);
    return status_of(self, answer);
}

int shim_invoke(Slave *self, PyObject *method, const char *name) {
    PyObject *answer = py.PyObject_CallNoArgs(method);
    if (!answer) {
        report_exception(self, name);
    }
    return status_of(self, answer);
}

long long shim_number(PyObject *answer, long long otherwise) {
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

PyObject *shim_view(const void *data, size_t count, size_t size) {
    union {
        const void *given;
        void *taken;
    } pointer = {data}; /* Python's function takes no const; PyBUF_READ keeps the promise */
    return view(pointer.taken, count, size, PyBUF_READ);
}

PyObject *shim_writable_view(void *data, size_t count, size_t size) {
    return view(data, count, size, PyBUF_WRITE);
}
