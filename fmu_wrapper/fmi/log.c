#include "host.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define MESSAGE 4096

static const char *const NAMES[LOG_CATEGORIES] = {"logEvents",      "logStatusWarning", "logStatusDiscard", "logStatusError",
                                                  "logCompilation", "logTraceback",     "logAll"};

static void say(const Host *host, int status, int category, const char *function, const char *format, va_list values) {
    char message[MESSAGE];
    int length = function ? snprintf(message, sizeof message, "%s: ", function) : 0;
    vsnprintf(message + length, sizeof message - (size_t)length, format, values);
    host->log(host, status, NAMES[category], message);
}

void host_say(const Host *host, int status, int category, const char *format, ...) {
    va_list values;
    if (host->heard & (1u << category)) {
        va_start(values, format);
        say(host, status, category, NULL, format, values);
        va_end(values);
    }
}

int host_error(const Host *host, const char *function, const char *format, ...) {
    va_list values;
    va_start(values, format);
    say(host, STATUS_ERROR, LOG_ERROR, function, format, values);
    va_end(values);
    return STATUS_ERROR;
}

unsigned host_heard(bool all) {
    return all ? (1u << LOG_CATEGORIES) - 1 : 0;
}

int host_hear(Host *host, const char *function, bool on, const char *const categories[], size_t count) {
    unsigned chosen = 0;
    for (size_t k = 0; k < count; k++) {
        int found = 0;
        while (found < LOG_CATEGORIES && !(categories[k] && strcmp(categories[k], NAMES[found]) == 0)) {
            found++;
        }
        if (found == LOG_CATEGORIES) {
            return host_error(host, function, "FmuValueError: unknown log categories ['%.60s']; known are those in "
                              "modelDescription.xml", categories[k] ? categories[k] : "NULL");
        }
        chosen |= 1u << found;
    }
    if (!chosen || (chosen & (1u << LOG_ALL))) {
        chosen = host_heard(true);
    }
    host->heard = on ? chosen : host->heard & ~chosen; /* switching off some leaves the others as they are */
    return STATUS_OK;
}
