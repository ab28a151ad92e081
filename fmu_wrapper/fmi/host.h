/* Who has made an instance: its callbacks, and what it is told. The same for both kinds of FMU and both versions of FMI. */
#ifndef TLISMNI_HOST_H
#define TLISMNI_HOST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined _WIN32
#define PRINTF_LIKE(text, first)
#else
#define PRINTF_LIKE(text, first) __attribute__((format(printf, text, first)))
#endif

/* Status numbers of FMI 2.0 and 3.0. */
typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL } Status;

enum { LOG_EVENTS, LOG_WARNING, LOG_DISCARD, LOG_ERROR, LOG_COMPILATION, LOG_TRACEBACK, LOG_ALL, LOG_CATEGORIES };

typedef struct Host Host;

/* Hands one message to the host, in the manner of the FMI version. */
typedef void (*HostLogger)(const Host *, int status, const char *category, const char *message);

/* Intermediate update at `time`, s (FMI 3.0): true if the host wants the step to end at `*end`. */
typedef bool (*HostUpdate)(Host *, double time, bool may_end_early, double *end);

struct Host {
    HostLogger log;
    void (*logger)(void); /* the host's callback, of the type that `log` knows; NULL for none */
    HostUpdate update;     /* NULL: the host wants no intermediate updates */
    void (*updater)(void); /* the host's callback, of the type that `update` knows */
    void *environment;
    char *name;     /* of the instance; NULL before there is one */
    unsigned heard; /* bits of the log categories */
    bool updating;  /* an intermediate update is under way */
};

/* Pass on a message if its category is heard. */
void host_say(const Host *host, int status, int category, const char *format, ...) PRINTF_LIKE(4, 5);

/* Log an error "function: what is wrong", heard or not, and answer with its status. */
int host_error(const Host *host, const char *function, const char *format, ...) PRINTF_LIKE(3, 4);

/* Hear some categories, or (none given) all; or no longer. STATUS_ERROR, with a line, for an unknown one. */
int host_hear(Host *host, const char *function, bool on, const char *const categories[], size_t count);

/* All categories, or none. */
unsigned host_heard(bool all);

#endif
