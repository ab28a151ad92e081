/* What the masters here have in common: the FMU's functions by name, and statuses that must be OK. */
#ifndef HOST_H
#define HOST_H

#include <stdio.h>
#include <stdlib.h>

#ifdef _WIN32
#include <windows.h>

#define RTLD_NOW 0
#define RTLD_LOCAL 0

static void *dlopen(const char *path, int mode) {
    (void)mode;
    return (void *)LoadLibraryA(path);
}

static void *dlsym(void *library, const char *name) {
    return (void *)GetProcAddress((HMODULE)library, name);
}

static const char *dlerror(void) {
    static char text[40];
    snprintf(text, sizeof text, "Windows' error %lu", GetLastError());
    return text;
}
#else
#include <dlfcn.h>
#endif

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
