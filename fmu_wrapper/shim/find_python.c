#include "find_python.h"

#include <stdlib.h>
#include <string.h>

#include "../fmi/files.h"

#define ADVICE                                                                                                  \
    "set the environment variable TLISMNI_PYTHON to the python executable of an environment that has tlismni's " \
    "packages (that of a venv will do)"

enum { OLDEST = 11, NEWEST = 30 };

/* What is known of a Python, a line each: shared library, home, a file of its standard library. */
typedef struct {
    char library[PATH_SIZE];
    char home[PATH_SIZE];
    char landmark[PATH_SIZE];
} Record;

static const char *next_line(const char *text, char *line) {
    size_t length = strcspn(text, "\r\n");
    snprintf(line, PATH_SIZE, "%.*s", (int)(length < PATH_SIZE ? length : PATH_SIZE - 1), text);
    text += length;
    text += *text == '\r';
    return text + (*text == '\n');
}

static void read_record(const char *text, Record *record) {
    text = next_line(text, record->library);
    text = next_line(text, record->home);
    next_line(text, record->landmark);
}

static void recorded_at_export(const char *resources, Record *record) {
    char path[PATH_SIZE + 32], text[3 * PATH_SIZE];
    size_t size = 0;
    snprintf(path, sizeof path, "%s/libpython.txt", resources);
    FILE *file = files_open(path);
    if (file) {
        size = fread(text, 1, sizeof text - 1, file);
        fclose(file);
    }
    text[size] = '\0';
    read_record(text, record);
}

static bool can_read(const char *path) {
    FILE *file = files_open(path);
    if (file) {
        fclose(file);
    }
    return file != NULL;
}

/* Minor version in a library's name (libpython3.11.so.1.0, python311.dll), or -1. */
static int minor_of(const char *library) {
    int minor = -1;
    for (const char *at = library; (at = strstr(at, "python3")) != NULL; at++) {
        const char *digits = at + strlen("python3");
        digits += *digits == '.';
        if (*digits >= '0' && *digits <= '9') {
            minor = atoi(digits);
        }
    }
    return minor;
}

static bool load_version(int minor, void **library) {
    static const char *const patterns[] = {
#if defined _WIN32
        "python3%d.dll",
#elif defined __APPLE__
        "libpython3.%d.dylib",
        "/Library/Frameworks/Python.framework/Versions/3.%d/Python",
        "/opt/homebrew/opt/python@3.%d/Frameworks/Python.framework/Versions/Current/Python",
        "/usr/local/opt/python@3.%d/Frameworks/Python.framework/Versions/Current/Python",
#else
        "libpython3.%d.so.1.0",
        "libpython3.%d.so",
#endif
    };
    char name[128];
    for (size_t i = 0; i < sizeof patterns / sizeof *patterns; i++) {
        snprintf(name, sizeof name, patterns[i], minor);
        *library = platform_load(name);
        if (*library) {
            return true;
        }
    }
    return false;
}

/* Load a library of the usual names, the recorded version first. */
static bool load_usual(int recorded_minor, void **library) {
    if (recorded_minor >= OLDEST && load_version(recorded_minor, library)) {
        return true;
    }
    for (int minor = NEWEST; minor >= OLDEST; minor--) {
        if (load_version(minor, library)) {
            return true;
        }
    }
    return false;
}

static void take(const Record *record, FoundPython *found) {
    memcpy(found->home, record->home, sizeof found->home);
    memcpy(found->landmark, record->landmark, sizeof found->landmark);
}

/* The Python that a person named: ask it where its library is. */
static bool load_of_program(const char *program, const char *resources, FoundPython *found, char *message,
                            size_t size) {
    char script[PATH_SIZE + 32], answer[3 * PATH_SIZE];
    Record record;
    snprintf(script, sizeof script, "%s/python_library.py", resources);
    if (platform_run(program, script, answer, sizeof answer) != 0) {
        snprintf(message, size, "TLISMNI_PYTHON names '%s', which does not run as a Python: set it to the path of a "
                 "python executable, such as that of a venv, or unset it", program);
        return false;
    }
    read_record(answer, &record);
    if (!record.library[0]) {
        snprintf(message, size, "TLISMNI_PYTHON names '%s', a Python without a shared library, which no other program "
                 "can load: name one that was built with it (--enable-shared; those of conda, uv, python.org and most "
                 "systems are)", program);
        return false;
    }
    found->library = platform_load(record.library);
    if (!found->library) {
        snprintf(message, size, "TLISMNI_PYTHON names '%s', whose library '%s' cannot be loaded: %s; name another "
                 "Python, or unset it", program, record.library, platform_load_error());
        return false;
    }
    take(&record, found);
    return true;
}

bool find_python(const char *resources, FoundPython *found, char *message, size_t size) {
    memset(found, 0, sizeof *found);
    if (platform_loaded_python(&found->library)) {
        return true;
    }
    const char *program = getenv("TLISMNI_PYTHON"), *chosen = getenv("TLISMNI_LIBPYTHON");
    if (program && *program) {
        return load_of_program(program, resources, found, message, size);
    }
    if (chosen && *chosen) {
        found->library = platform_load(chosen);
        if (!found->library) {
            snprintf(message, size, "TLISMNI_LIBPYTHON names '%s', which cannot be loaded: %s; correct or unset it",
                     chosen, platform_load_error());
        }
        return found->library != NULL;
    }
    Record record;
    recorded_at_export(resources, &record);
    char cause[PATH_SIZE + 256] = "none was recorded in resources/libpython.txt";
    if (record.library[0]) {
        found->library = platform_load(record.library);
        if (found->library) {
            take(&record, found);
            return true;
        }
        snprintf(cause, sizeof cause, "the one of the export cannot be loaded (%.*s)", PATH_SIZE,
                 platform_load_error());
    }
    if (load_usual(minor_of(record.library), &found->library)) {
        return true;
    }
    snprintf(message, size, "no Python library found: %s, and the system has no libpython3.%d to 3.%d; " ADVICE,
             cause, OLDEST, NEWEST);
    return false;
}

/* Cut off the last part of a path; false if there is none. */
static bool go_up(char *path) {
    char *slash = strrchr(path, '/');
    if (!slash) {
        return false;
    }
    *slash = '\0';
    return true;
}

/* Look for the standard library above the library. */
static bool home_above(FoundPython *found, int minor) {
    static const char *const places[] = {
#ifdef _WIN32
        "%s/Lib/os.py",
#else
        "%s/lib/python3.%d/os.py",
        "%s/lib64/python3.%d/os.py",
#endif
    };
    char path[PATH_SIZE];
    platform_path_of(found->library, "Py_GetVersion", path, sizeof path);
    for (int up = 0; up < 3 && go_up(path); up++) {
        for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
            char landmark[PATH_SIZE + 64];
            snprintf(landmark, sizeof landmark, places[i], path, minor);
            if (can_read(landmark)) {
                snprintf(found->home, sizeof found->home, "%s", path);
                return true;
            }
        }
    }
    return false;
}

bool python_home(FoundPython *found, const char *version, char *message, size_t size) {
    if (found->home[0]) {
        if (!can_read(found->landmark)) {
            snprintf(message, size, "the Python that the FMU was exported with is incomplete: '%s' cannot be read; "
                     "repair it, or " ADVICE, found->landmark);
            return false;
        }
        return true;
    }
    int minor = strncmp(version, "3.", 2) == 0 ? atoi(version + 2) : -1;
    if (!home_above(found, minor)) {
        snprintf(message, size, "a library of Python %.8s was found, but not its standard library: " ADVICE
                 ", or PYTHONHOME to the folder that has lib/python3.%d", version, minor);
        return false;
    }
    return true;
}
