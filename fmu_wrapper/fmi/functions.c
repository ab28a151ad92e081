#include "functions.h"

#include <stdlib.h>

#include "location.h"

static bool are_there(const Host *host, const char *function, const void *items, size_t count) {
    if (count && (!items || count > PTRDIFF_MAX / sizeof(double))) {
        host_error(host, function, "FmuValueError: NULL was given for an array or an answer, or a length beyond all memory: "
                   "pass its address, and its length");
        return false;
    }
    return true;
}

bool are_given(const Slave *c, const char *function, const void *items, size_t count) {
    const Host *host = slave_host(c);
    return host && are_there(host, function, items, count);
}

bool is_given(const Slave *c, const char *function, const void *answer) {
    return are_given(c, function, answer, 1);
}

bool both_given(const Slave *c, const char *function, const void *references, const void *values, size_t count) {
    return are_given(c, function, references, count) && are_given(c, function, values, count);
}

bool is_of_length(const Slave *c, const char *function, size_t n, size_t values) {
    const Host *host = slave_host(c);
    if (host && n != values) {
        host_error(host, function, "FmuValueError: room for %zu values was given for %zu scalar variables", values, n);
        return false;
    }
    return host != NULL;
}

bool is_complete(const Slave *c, const char *function, const Question *q) {
    return are_given(c, function, q->unknown, q->unknowns) && are_given(c, function, q->known, q->knowns) &&
           are_given(c, function, q->seed, q->seeds) && are_given(c, function, q->sensitivity, q->sensitivities);
}

Slave *instantiate(Host *host, const Asked *asked, const char *function, const char *name, const char *token,
                   const char *resource_location) {
    Slave *made = NULL;
    char *resources = resource_location ? location_path(resource_location) : NULL;
    host->name = text_copy(name && *name ? name : "instance");
    host->heard = host_heard(asked->logging_on);
    if (!are_there(host, function, asked->intermediate, asked->intermediates)) {
        made = NULL;
    } else if (!resource_location) {
        host_error(host, function, "the resource location is NULL: the URI of the FMU's resources folder is needed");
    } else if (!resources || !host->name) {
        host_error(host, function, "there is no memory left for an instance");
    } else {
        made = slave_new(host, asked, function, token ? token : "", resources);
    }
    free(resources);
    if (!made) {
        free(host->name);
    }
    return made;
}

void free_instance(Slave *c, const char *function) {
    Host *host = slave_host(c);
    if (host && host->updating) {
        host_error(host, function, "the instance is not freed: return from the callback of the intermediate update first");
    } else if (host) {
        char *name = host->name;
        slave_free(c);
        free(name);
    }
}

int choose_log(Slave *c, const char *function, bool on, const char *const categories[], size_t count) {
    int status = IF(are_given(c, function, categories, count), host_hear(slave_host(c), function, on, categories, count));
    return status == STATUS_OK ? slave_log_chosen(c, function, on, categories, count) : status;
}

int free_state(Slave *c, const char *function, void **state) {
    void *handle = state ? *state : NULL;
    if (!slave_host(c)) {
        return STATUS_ERROR;
    }
    if (!handle) {
        return STATUS_OK;
    }
    *state = NULL;
    return slave_free_state(c, function, handle);
}
