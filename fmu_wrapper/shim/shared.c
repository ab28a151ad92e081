#include "shared.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const List *lists_find(Lists *lists, const uint32_t references[], size_t count) {
    size_t bytes = count * sizeof *references;
    for (size_t k = 0; k < lists->count; k++) {
        size_t at = (lists->last + k) % lists->count; /* hosts come with the same lists in turn */
        const List *list = &lists->lists[at];
        if (list->count == count && memcmp(list->references, references, bytes) == 0) {
            lists->last = at + 1;
            return list;
        }
    }
    return NULL;
}

/* Where a new list goes; MOST_LISTS for nowhere. */
static size_t room(const Lists *lists) {
    size_t place = lists->count;
    for (size_t k = 0; place == MOST_LISTS && k < MOST_LISTS; k++) {
        place = lists->lists[k].values ? place : k; /* a host that sets many parameters one by one leaves many of these */
    }
    return place;
}

bool lists_full(const Lists *lists) {
    return room(lists) == MOST_LISTS;
}

static void forget(List *list) {
    free(list->references);
    free(list->places);
}

static void *copy_of(const void *data, size_t bytes) {
    void *copy = malloc(bytes ? bytes : 1);
    if (copy && bytes) {
        memcpy(copy, data, bytes);
    }
    return copy;
}

void lists_add(Lists *lists, const uint32_t references[], size_t count, const char *places, size_t values) {
    size_t place = room(lists);
    if (place == MOST_LISTS || (place < lists->count && !values)) {
        return;
    }
    List list = {copy_of(references, count * sizeof *references), count,
                 copy_of(places, values * sizeof *list.places), values};
    if (!list.references || !list.places) {
        forget(&list);
    } else if (place == lists->count) {
        lists->lists[lists->count++] = list;
    } else {
        forget(&lists->lists[place]);
        lists->lists[place] = list;
    }
}

void lists_free(Lists *lists) {
    for (size_t k = 0; k < lists->count; k++) {
        forget(&lists->lists[k]);
    }
    lists->count = 0;
}

bool shared_unsettled(const Shared *shared) {
    return shared && (shared->behind || !shared->told);
}

void shared_forget(Shared *shared) {
    if (shared) {
        shared->horizon = -HUGE_VAL;
        shared->settable = shared->fresh = 0;
    }
}

bool shared_glide(Shared *shared, double time, double step) {
    if (!shared) {
        return false;
    }
    double end = time + step, size = fabs(time) > step ? fabs(time) : step;
    double rounding = 4.0 * DBL_EPSILON * size; /* of a master's clock */
    if (!(step > 0.0 && fabs(time - shared->time) <= rounding && end > shared->time && end <= shared->horizon)) {
        return false;
    }
    shared->time = end;
    shared->behind = 1;
    shared->fresh = 0;
    shared->asked = shared->asked ? shared->asked : GLIDE;
    return true;
}

void shared_asked(Shared *shared) {
    if (shared && !shared->asked) {
        shared->asked = READING;
    }
}

void shared_read(Shared *shared, const List *list, double value[]) {
    for (size_t i = 0; i < list->values; i++) {
        value[i] = shared->values[list->places[i]];
    }
    shared_asked(shared);
}

bool shared_write(Shared *shared, const List *list, const double value[]) {
    for (size_t i = 0; i < list->values; i++) {
        if (!isfinite(value[i])) {
            return false;
        }
    }
    for (size_t i = 0; i < list->values; i++) {
        double *place = &shared->values[list->places[i]];
        if (memcmp(place, &value[i], sizeof *place) != 0) { /* by bits: what is set again as it is changes nothing */
            *place = value[i];
            shared->told = shared->fresh = 0;
            shared->horizon = -HUGE_VAL;
        }
    }
    return true;
}
