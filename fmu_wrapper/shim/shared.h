/* What an instance shares with its Python side: the real values and what holds of them, so that calls whose answer is
 * known need no Python. */
#ifndef TLISMNI_SHARED_H
#define TLISMNI_SHARED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Number of the layout below and of what it means; a new one with each change, here and in shared.py. */
#ifndef SHARED_LAYOUT
#define SHARED_LAYOUT 1
#endif

enum { READING = 1, GLIDE = 2 };

/* In memory of the Python side (shared.py), which lives as long as the instance's calls. */
typedef struct {
    double time;    /* of the instance */
    double horizon; /* up to this time, as of the last step, steps only move the clock; -inf: there is nothing of that */
    double point, step; /* of a step that is asked */
    double reached;     /* where the last step has ended */
    int64_t event_due, early; /* how */
    int64_t behind;   /* the Python side has not been told that `time` has moved */
    int64_t told;     /* 0: the Python side has not been told of inputs among `values` */
    int64_t settable; /* inputs can be set here: each of `values` that is one is what the slave has */
    int64_t fresh;    /* each of `values` is what the slave has at this time, with these inputs */
    int64_t asked;    /* what came after the last step that Python made, first of all: nothing yet, a READING, a GLIDE */
    double values[];  /* of all reals */
} Shared;

/* Lists of value references that the host has come with, and where their values are. */
enum { MOST_LISTS = 64 };
typedef struct {
    uint32_t *references;
    size_t count;
    int32_t *places;
    size_t values; /* 0: not to be answered here */
} List;
typedef struct {
    List lists[MOST_LISTS];
    size_t count, last;
} Lists;

/* The list with these references, or NULL. */
const List *lists_find(Lists *lists, const uint32_t references[], size_t count);

/* Keep a list with the places of its values (as many as `values`). Beyond MOST_LISTS it takes the place of one that is
 * not to be answered here, else it is not kept. */
void lists_add(Lists *lists, const uint32_t references[], size_t count, const char *places, size_t values);

/* Whether no list is kept any more. */
bool lists_full(const Lists *lists);

void lists_free(Lists *lists);

/* `shared` may be NULL in all of these. */

/* Whether the Python side has to be told of steps or inputs. */
bool shared_unsettled(const Shared *shared);

/* The slave has changed, nobody knows how: nothing is promised any more. */
void shared_forget(Shared *shared);

/* Make a step without Python, if it is within the horizon and starts at the instance's own time. */
bool shared_glide(Shared *shared, double time, double step);

/* Values are read. */
void shared_asked(Shared *shared);

/* The values of a list, which must be fresh. */
void shared_read(Shared *shared, const List *list, double value[]);

/* Set the inputs of a list; false, with nothing done, if one is not finite. */
bool shared_write(Shared *shared, const List *list, const double value[]);

#endif
