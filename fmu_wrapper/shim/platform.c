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

void platform_path_of(void *library, const char *name, char *path, size_t size) {
    wchar_t buffer[4096];
    DWORD length = GetModuleFileNameW((HMODULE)library, buffer, sizeof buffer / sizeof *buffer);
    (void)name;
    path[0] = '\0';
    if (length && length < sizeof buffer / sizeof *buffer) {
        if (!WideCharToMultiByte(CP_UTF8, 0, buffer, -1, path, (int)size, NULL, NULL)) {
            path[0] = '\0';
        }
    }
    for (; *path; path++) {
        *path = *path == '\\' ? '/' : *path;
    }
}

int platform_run(const char *program, const char *script, char *output, size_t size) {
    char command[8192];
    output[0] = '\0';
    if (strchr(program, '"') || strchr(script, '"')) {
        return -1; /* no file name has it */
    }
    /* cmd.exe takes away the outermost quotes */
    snprintf(command, sizeof command, "\"\"%s\" -I \"%s\" 2>NUL\"", program, script);
    wchar_t *name = wide(command);
    FILE *pipe = name ? _wpopen(name, L"rb") : NULL;
    free(name);
    if (!pipe) {
        return -1;
    }
    output[fread(output, 1, size - 1, pipe)] = '\0';
    return _pclose(pipe);
}

void platform_pin(void) {
    HMODULE self;
    GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_PIN,
                       (LPCWSTR)(void *)&platform_pin, &self);
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

static HANDLE process_lock;

void platform_lock_process(void) {
    char name[64];
    snprintf(name, sizeof name, "Local\\tlismni-start-%lu", (unsigned long)GetCurrentProcessId());
    process_lock = CreateMutexA(NULL, FALSE, name);
    if (process_lock) {
        WaitForSingleObject(process_lock, INFINITE);
    }
}

void platform_unlock_process(void) {
    if (process_lock) {
        ReleaseMutex(process_lock);
        CloseHandle(process_lock);
    }
}

#else /* Linux, macOS */

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <spawn.h>
#include <stdint.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

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

void platform_path_of(void *library, const char *name, char *path, size_t size) {
    Dl_info info;
    void *function = dlsym(library, name);
    char *resolved = function && dladdr(function, &info) && info.dli_fname ? realpath(info.dli_fname, NULL) : NULL;
    snprintf(path, size, "%s", resolved ? resolved : "");
    free(resolved);
}

int platform_run(const char *program, const char *script, char *output, size_t size) {
    int ends[2], status = -1;
    output[0] = '\0';
    if (pipe(ends) != 0) {
        return -1;
    }
    char *arguments[] = {(char *)(uintptr_t)program, "-I", (char *)(uintptr_t)script, NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    int failed = posix_spawnp(&child, program, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (!failed) {
        size_t used = 0;
        while (used < size - 1) {
            ssize_t got = read(ends[0], output + used, size - 1 - used);
            if (got > 0) {
                used += (size_t)got;
            } else if (got == 0 || errno != EINTR) {
                break;
            }
        }
        output[used] = '\0';
        pid_t ended;
        while ((ended = waitpid(child, &status, 0)) < 0 && errno == EINTR) {
        }
        if (ended < 0) {
            status = used ? 0 : -1; /* the host has its children reaped by the system */
        }
    }
    close(ends[0]);
    return status;
}

void platform_pin(void) {
    static const char here;
    Dl_info info;
    if (dladdr(&here, &info) && info.dli_fname) {
        dlopen(info.dli_fname, RTLD_NOW | RTLD_NOLOAD | RTLD_NODELETE);
    }
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

/* The libraries do not know one another. What they share is the C library, and in it the lock of a stream: it is held
 * for the tenth of a second in which Python starts, and keeps nobody from anything but writing to it. */
void platform_lock_process(void) {
    flockfile(stderr);
}

void platform_unlock_process(void) {
    funlockfile(stderr);
}

#endif
