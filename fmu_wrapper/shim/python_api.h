/* Python without Python.h: functions of CPython's stable ABI, found when the first instance is made.
 *
 * So one binary serves every Python from 3.11 on, and a host that is no Python needs nothing in its environment.
 */
#ifndef TLISMNI_PYTHON_API_H
#define TLISMNI_PYTHON_API_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "platform.h"

typedef struct PyObject PyObject;
typedef intptr_t Py_ssize_t;
typedef PyObject *(*PyCFunction)(PyObject *, PyObject *);

/* Layout fixed by the stable ABI. */
typedef struct {
    const char *ml_name;
    PyCFunction ml_meth;
    int ml_flags;
    const char *ml_doc;
} PyMethodDef;

enum { METH_VARARGS = 1, Py_file_input = 257, PyBUF_READ = 0x100, PyBUF_WRITE = 0x200 };
enum { PyGILState_LOCKED = 0, PyGILState_UNLOCKED = 1 };

#define PYTHON_FUNCTIONS(X)                                                      \
    X(int, Py_IsInitialized, (void))                                             \
    X(void, Py_InitializeEx, (int))                                              \
    X(const char *, Py_GetVersion, (void))                                       \
    X(int, PySys_SetObject, (const char *, PyObject *))                          \
    X(PyObject *, PySys_GetObject, (const char *))                               \
    X(int, PyGILState_Ensure, (void))                                            \
    X(void, PyGILState_Release, (int))                                           \
    X(void *, PyEval_SaveThread, (void))                                         \
    X(void, PyEval_RestoreThread, (void *))                                      \
    X(PyObject *, PyEval_GetBuiltins, (void))                                    \
    X(PyObject *, PyEval_EvalCode, (PyObject *, PyObject *, PyObject *))         \
    X(PyObject *, Py_CompileString, (const char *, const char *, int))           \
    X(PyObject *, Py_BuildValue, (const char *, ...))                            \
    X(PyObject *, Py_VaBuildValue, (const char *, va_list))                      \
    X(void, Py_DecRef, (PyObject *))                                             \
    X(int, PyArg_ParseTuple, (PyObject *, const char *, ...))                    \
    X(PyObject *, PyCFunction_NewEx, (PyMethodDef *, PyObject *, PyObject *))    \
    X(PyObject *, PyCapsule_New, (void *, const char *, void (*)(PyObject *)))   \
    X(void *, PyCapsule_GetPointer, (PyObject *, const char *))                  \
    X(PyObject *, PyDict_New, (void))                                            \
    X(PyObject *, PyDict_GetItemString, (PyObject *, const char *))              \
    X(int, PyDict_SetItemString, (PyObject *, const char *, PyObject *))         \
    X(PyObject *, PyObject_GetAttrString, (PyObject *, const char *))            \
    X(PyObject *, PyObject_CallObject, (PyObject *, PyObject *))                 \
    X(PyObject *, PyObject_CallNoArgs, (PyObject *))                             \
    X(PyObject *, PyObject_Str, (PyObject *))                                    \
    X(PyObject *, PyUnicode_AsUTF8String, (PyObject *))                          \
    X(PyObject *, PyBytes_FromString, (const char *))                            \
    X(char *, PyBytes_AsString, (PyObject *))                                    \
    X(Py_ssize_t, PyBytes_Size, (PyObject *))                                    \
    X(PyObject *, PyList_New, (Py_ssize_t))                                      \
    X(int, PyList_SetItem, (PyObject *, Py_ssize_t, PyObject *))                 \
    X(PyObject *, PyList_GetItem, (PyObject *, Py_ssize_t))                      \
    X(Py_ssize_t, PyList_Size, (PyObject *))                                     \
    X(long, PyLong_AsLong, (PyObject *))                                         \
    X(long long, PyLong_AsLongLong, (PyObject *))                                \
    X(PyObject *, PyMemoryView_FromMemory, (char *, Py_ssize_t, int))            \
    X(PyObject *, PyErr_Occurred, (void))                                        \
    X(void, PyErr_Clear, (void))                                                 \
    X(void, PyErr_Fetch, (PyObject **, PyObject **, PyObject **))                \
    X(void, PyErr_NormalizeException, (PyObject **, PyObject **, PyObject **))

#define DECLARE(result, name, arguments) result(*name) arguments;
typedef struct {
    PYTHON_FUNCTIONS(DECLARE)
} PythonApi;
#undef DECLARE

/* The functions; valid after python_start. */
extern PythonApi py;

/* Find Python and start it if nobody has. On false, `message` says what was tried and what to do. */
bool python_start(const char *resources, char *message, size_t size);

/* Whether python_start has started it, that of another FMU perhaps: then nobody else needs its environment. With
 * Python's lock. */
bool python_is_own(void);

/* Take the interpreter's lock for this thread. False if Python is not (or no longer) running. */
bool python_enter(int *gil);

/* Give back what python_enter took. */
void python_leave(int gil);

/* Put "Type: message" of the pending exception into `message`, and clear it. */
void python_error(char *message, size_t size);

#endif
