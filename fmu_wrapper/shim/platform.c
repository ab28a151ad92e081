#if !defined _WIN32 && !defined _GNU_SOURCE
#define _GNU_SOURCE /* dladdr, RTLD_DEFAULT */
#endif
#include "platform.h"

#include <stdlib.h>
#include <string.h>

#ifdef _WIN32

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

static SRWLOCK lock = SRWLOCK_INIT;

static wchar_t *wide(const char *text) {
    int size = MultiByteToWideChar(CP_UTF8, 0, text, -1, NULL, 0);
    wchar_t *result = malloc((size_t)size * sizeof *result);
    if (result) {
        MultiByteToWideChar(CP_UTF8, 0, text, -1, result, size);
    }
    return result;
}

void *platform_load(const char *path) {
    wchar_t *name = wide(path);
    HMODULE library = NULL;
    if (name) {
        /* the folder of the library is searched too: python3xx.dll needs its vcruntime beside it */
        bool is_path = strchr(path, '\\') || strchr(path, '/');
        library = LoadLibraryExW(name, NULL, is_path ? LOAD_WITH_ALTERED_SEARCH_PATH : 0);
        free(name);
    }
    return library; /* never freed, so never unloaded */
}

bool platform_loaded_python(void **library) {
    char name[32];
    for (int minor = 11; minor < 40; minor++) {
        snprintf(name, sizeof name, "python3%d.dll", minor);
        *library = GetModuleHandleA(name);
        if (*library) {
            return true;
        }
    }
    return false;
}

void *platform_symbol(void *library, const char *name) {
    return (void *)GetProcAddress((HMODULE)library, name);
}

const char *platform_load_error(void) {
    static _Thread_local char text[64];
    snprintf(text, sizeof text, "Windows error %lu", (unsigned long)GetLastError());
    return text;
}

void platform_pin(void) {
    HMODULE self;
    GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_PIN,
                       (LPCWSTR)(void *)&platform_pin, &self);
}

FILE *platform_open(const char *path) {
    wchar_t *name = wide(path);
    FILE *file = name ? _wfopen(name, L"rb") : NULL;
    free(name);
    return file;
}

void platform_setenv(const char *name, const char *value) {
    _putenv_s(name, value ? value : "");
}

void platform_lock(void) {
    AcquireSRWLockExclusive(&lock);
}

void platform_unlock(void) {
    ReleaseSRWLockExclusive(&lock);
}

#else /* Linux, macOS */

#include <dlfcn.h>
#include <pthread.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

void *platform_load(const char *path) {
    return dlopen(path, RTLD_NOW | RTLD_GLOBAL | RTLD_NODELETE);
}

bool platform_loaded_python(void **library) {
    *library = RTLD_DEFAULT;
    return dlsym(RTLD_DEFAULT, "Py_IsInitialized") != NULL;
}

void *platform_symbol(void *library, const char *name) {
    return dlsym(library, name);
}

const char *platform_load_error(void) {
    const char *text = dlerror();
    return text ? text : "unknown cause";
}

void platform_pin(void) {
    static const char here;
    Dl_info info;
    if (dladdr(&here, &info) && info.dli_fname) {
        dlopen(info.dli_fname, RTLD_NOW | RTLD_NOLOAD | RTLD_NODELETE);
    }
}

FILE *platform_open(const char *path) {
    return fopen(path, "rb");
}

void platform_setenv(const char *name, const char *value) {
    if (value) {
        setenv(name, value, 1);
    } else {
        unsetenv(name);
    }
}

void platform_lock(void) {
    pthread_mutex_lock(&lock);
}

void platform_unlock(void) {
    pthread_mutex_unlock(&lock);
}

#endif
