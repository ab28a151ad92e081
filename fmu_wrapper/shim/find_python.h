/* Which Python a host that is no Python shall start. */
#ifndef TLISMNI_FIND_PYTHON_H
#define TLISMNI_FIND_PYTHON_H

#include "platform.h"

enum { PATH_SIZE = 4096 };

typedef struct {
    void *library;             /* its functions; NULL may mean the whole process */
    char home[PATH_SIZE];      /* PYTHONHOME, empty if it is not known */
    char landmark[PATH_SIZE];  /* a file of its standard library */
} FoundPython;

/* Find the library that has Python: in the process; of the Python that TLISMNI_PYTHON names; the one that
 * TLISMNI_LIBPYTHON names; as recorded at export; by the usual names. On false, `message` says what was tried and what
 * to set. */
bool find_python(const char *resources, FoundPython *found, char *message, size_t size);

/* Make sure that `found` has a home with a standard library for `version` ("3.11.4 ..."). */
bool python_home(FoundPython *found, const char *version, char *message, size_t size);

#endif
