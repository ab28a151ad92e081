/* Images and runs, as the C files of this folder see them. What stands in an image: `layout.py`, `image_file.py`. */
#ifndef TLISMNI_IMAGE_H
#define TLISMNI_IMAGE_H

#include "tlismni.h"

#define IMAGE_MAGIC "TLISMNI\x01"
#define IMAGE_VERSION 1
#define DIGEST_BYTES 32 /* of what compiled code is made of, then that of the C sources */
#define SOURCES_BYTES 16
#define ALIGNED 64

/* The head, behind magic and digest. */
typedef struct {
    int64_t version, size, checksum;
    int64_t shared, tables, decisive, copied, own;
    int64_t functions, function_text, texts, text_size;
    int64_t parameters, words, coefficients, exclusions;
    int64_t shared_shared, shared_function, own_own, own_shared, own_function;
} Head;

typedef struct {
    int64_t inputs, channels, contacts, n, event_rows, most_steps, chunk, redundant, events, begins, matrix_words;
    double start, punctual;
} Numbers;

typedef struct {
    int64_t exchange, drive, reads, budget, times, inputs, channels, goals, counts, events, pending, counters,
        method_times, ring, parameters, begin, begin_numbers, rates, workspace;
} Places;

/* A parameter, and a word of a run's memory that follows from it: `form` says how (parameters.c). `begins`: the run begins
 * anew with another value. `first`, `count`: of a parameter its words, of a word its coefficients.
 * `mode`: how it follows from several parameters. */
typedef struct {
    int64_t first, count, begins;
    double value, least, largest;
} Parameter;

typedef struct {
    int64_t place, form, mode, first, count;
    double constant;
} Word;
enum { SERIES = 64 };            /* of `form` */
enum { ALONE, PRODUCT, SUM };    /* of `mode` */

/* Two parameters of which one at most has another value than that of the image. */
typedef struct {
    int64_t one, other;
} Exclusion;

/* The functions that the C code calls: the first ones of the image's list. */
enum { EXCHANGE, TELL, READ, DRIVE, SETTLE, REPAIR, ALONG, IN_TIME, BEGIN, MATRIX_WORDS, SAVE_MATRICES,
       RESTORE_MATRICES, WANT, NORMALISE, CALLED };

typedef void (*Function)(void);

struct tlismni_model {
    Head head;
    Numbers numbers;
    Places places;
    const int64_t *own_own, *own_shared, *own_function; /* words of a run's memory that are addresses */
    const Parameter *parameters;
    const Word *words;
    const double *coefficients;
    const Exclusion *exclusions;
    Function *functions;
    const char **texts;     /* names of inputs, channels, contacts, parameters */
    const char *own_bytes;  /* a run's memory at the start, with places for addresses */
    char *shared;           /* what runs share, aligned */
    char *bytes;            /* the image */
    void *room;             /* that `shared` is in */
};

/* What decides the future of a run besides its memory. */
typedef struct {
    double now;
    int64_t failed, begun; /* since the start */
    int64_t stale;         /* 1: the run has to begin anew before anything else */
} Beside;

/* What decides nothing, and goes with a state all the same. */
typedef struct {
    int64_t events;    /* since the start */
    int64_t beginning; /* which start it goes on from: matrices of another one do not count */
} Noted;

struct tlismni_run {
    const tlismni_model *model;
    char *own;        /* its memory, aligned */
    void *allocated;  /* by `tlismni_start`; NULL if the memory is the caller's */
    int64_t limit;
    int64_t beginnings; /* the last number that `beginning` had */
    Beside beside;
    Noted noted;
};

/* Places in a run's memory. */
#define WHOLES(run, name) ((int64_t *)((run)->own + (run)->model->places.name))
#define REALS(run, name) ((double *)((run)->own + (run)->model->places.name))
#define GOALS(run) ((Goals *)REALS(run, goals))
#define COUNTS(run) ((Counts *)WHOLES(run, counts))
#define COUNTERS(run) ((Counters *)WHOLES(run, counters))

/* A function of the library by its symbol, NULL if there is none. */
Function image_function(const char *symbol);

uint32_t image_checksum(const void *bytes, size_t size);

#endif
