/* What the masters here have in common: the FMU's functions by name, and statuses that must be OK. */
#ifndef HOST_H
#define HOST_H

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

/* The function `name` of the `library` in scope, as a variable of this name. */
#define LOAD(name) name##TYPE *name = (name##TYPE *)find(library, #name)
/* OK is 0 in FMI 2.0 and 3.0. */
#define CHECK(call) do { if ((call) != 0) { fprintf(stderr, "failed: %s\n", #call); exit(3); } } while (0)

static void *find(void *library, const char *name) {
    void *function = dlsym(library, name);
    if (!function) {
        fprintf(stderr, "%s\n", dlerror());
        exit(2);
    }
    return function;
}

#endif
