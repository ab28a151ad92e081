/* What differs between Windows, macOS and Linux. */
#ifndef TLISMNI_PLATFORM_H
#define TLISMNI_PLATFORM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The library with this file name or path, made visible to libraries loaded later and never unloaded; or NULL. */
void *platform_load(const char *path);

/* Find the library of this process that has Python in it already (its handle may be NULL: the whole process). */
bool platform_loaded_python(void **library);

/* Address of a function of `library`, or NULL. */
void *platform_symbol(void *library, const char *name);

/* Path of the file that a function of `library` comes from, as UTF-8, links resolved; empty if it is unknown. */
void platform_path_of(void *library, const char *name, char *path, size_t size);

/* Run `program` with the file `script` as its one argument and read what it prints, at most `size` - 1 bytes.
 * Gives its exit status, or -1 if it cannot be run. */
int platform_run(const char *program, const char *script, char *output, size_t size);

/* Why the last platform_load failed. */
const char *platform_load_error(void);

/* Keep this library in the process for good: Python holds pointers into it. */
void platform_pin(void);

/* Set an environment variable, or unset it with NULL. */
void platform_setenv(const char *name, const char *value);

/* One lock for the whole library. */
void platform_lock(void);
void platform_unlock(void);

/* One lock for all libraries of this kind in the process: each FMU has its own. */
void platform_lock_process(void);
void platform_unlock_process(void);

#endif
