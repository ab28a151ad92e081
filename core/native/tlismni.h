/* tlismni without Python: a mechanism that was prepared with Python, as an image of numbers, goes on from there in C.
 *
 * An image is made by `tlismni.core.native.image_of`. A *model* is an image in memory, a
 * *run* is a copy of its working memory: as many as wanted, each used by one thread at a time, all sharing the model.
 * Units are SI. What is said here of bits: a run gives the same bits as the same run in Python, on the same libm.
 *
 * Nothing here writes to files or screens. `tlismni_open` and `tlismni_start` allocate, `tlismni_start_in` does not; steps
 * take small pieces from a stack of the thread, and give them back before they return (docs/embedding.md). */
#ifndef TLISMNI_H
#define TLISMNI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* On Windows too, where compilers of the kind of gcc hide what is not said to be seen; `__declspec(dllexport)` would hide the
 * compiled functions, which say nothing. */
#if defined _MSC_VER && !defined __clang__
#define TLISMNI_API
#else
#define TLISMNI_API __attribute__((visibility("default")))
#endif

typedef struct tlismni_model tlismni_model;
typedef struct tlismni_run tlismni_run;

/* What calls that may fail answer with: 0, or a code that `tlismni_why` puts into words. */
typedef int tlismni_status;
enum { TLISMNI_OK = 0 };

/* Names of an image, and how many there are. */
typedef enum { TLISMNI_INPUT, TLISMNI_CHANNEL, TLISMNI_CONTACT, TLISMNI_PARAMETER } tlismni_kind;

/* A contact event. */
typedef struct {
    double time;          /* s */
    int kind;             /* TLISMNI_IMPACT ... */
    int contact;          /* its number among the contacts */
    double impulse;       /* N s; along a line that turns: N m s */
    double energy_loss;   /* J */
    double approach_speed, separation_speed; /* m/s */
    double friction_impulse, sliding_speed;  /* N s, m/s */
} tlismni_event;
enum { TLISMNI_IMPACT, TLISMNI_GRAZE, TLISMNI_REST, TLISMNI_CLOSE, TLISMNI_OPENS, TLISMNI_SLIP, TLISMNI_STICK };

/* --- models ------------------------------------------------------------------------------------------------------ */

/* The model in a file, or in `size` bytes of memory, which are copied. NULL on failure, with the reason in `why`, which
 * has room for `room` bytes. */
TLISMNI_API tlismni_model *tlismni_open(const char *path, char *why, size_t room);
TLISMNI_API tlismni_model *tlismni_read_image(const void *bytes, size_t size, char *why, size_t room);

/* Free a model, after its runs. NULL is allowed. */
TLISMNI_API void tlismni_close(tlismni_model *model);

TLISMNI_API size_t tlismni_count(const tlismni_model *model, tlismni_kind kind);
/* Name of one of them, NULL beyond the last; `tlismni_find` gives the number of a name, -1 for none. */
TLISMNI_API const char *tlismni_name(const tlismni_model *model, tlismni_kind kind, size_t number);
TLISMNI_API long tlismni_find(const tlismni_model *model, tlismni_kind kind, const char *name);

/* --- runs -------------------------------------------------------------------------------------------------------- */

/* A run at the point at which the image was made. NULL without memory. `tlismni_end` frees it; NULL is allowed. */
TLISMNI_API tlismni_run *tlismni_start(const tlismni_model *model);
TLISMNI_API void tlismni_end(tlismni_run *run);

/* The same in memory of one's own, of `tlismni_run_size` bytes, aligned to 64. NULL if it is not. */
TLISMNI_API size_t tlismni_run_size(const tlismni_model *model);
TLISMNI_API tlismni_run *tlismni_start_in(const tlismni_model *model, void *memory, size_t size);

/* Back to the point at which the image was made, in the same memory. */
TLISMNI_API void tlismni_restart(tlismni_run *run);

/* A parameter's value: that of the image, unless another one is set. Between the start of a run (or its restart) and the
 * first call that goes on or looks, a parameter takes any value from `least` to `largest`: the run is then that of the
 * model with this value. Where the start follows from it, the first call has the start: that may fail, for a value with which
 * the model cannot start. It keeps it until it is restarted; a state has it too. */
TLISMNI_API double tlismni_parameter(const tlismni_run *run, size_t number);
TLISMNI_API tlismni_status tlismni_set_parameter(tlismni_run *run, size_t number, double value);

/* The parameter that keeps this one at its value in the image, as long as it has another value than that itself: numbers
 * follow from both in a way that the image does not have. The number of parameters if there is none. */
TLISMNI_API size_t tlismni_excluded_by(const tlismni_run *run, size_t number);
TLISMNI_API tlismni_status tlismni_parameter_range(const tlismni_model *model, size_t number, double *least,
                                                   double *largest);

/* Let the run begin at time `t` (s) instead: forces, drivers and events are then those of that time. Between the start of a
 * run and the first call that goes on or looks. */
TLISMNI_API tlismni_status tlismni_start_at(tlismni_run *run, double t);
TLISMNI_API double tlismni_start_time(const tlismni_run *run);

/* Present time, s; and the time up to which the run is computed already. */
TLISMNI_API double tlismni_time(const tlismni_run *run);
TLISMNI_API double tlismni_computed(const tlismni_run *run);

/* The inputs: what is written here counts from the next call on. */
TLISMNI_API double *tlismni_inputs(tlismni_run *run);

/* First and second time derivative with which an input goes on from the present time: its value, and the first one, move along
 * with the time until other derivatives are given. `tlismni_rates_of` gives them, and the time at which they were given. */
TLISMNI_API tlismni_status tlismni_set_rates(tlismni_run *run, size_t number, double first, double second);
TLISMNI_API void tlismni_rates_of(const tlismni_run *run, size_t number, double *first, double *second, double *since);

/* The channels, as the last `tlismni_step` with `read` or `tlismni_look` has left them. */
TLISMNI_API const double *tlismni_channels(const tlismni_run *run);

/* Which channels are read from now on: all of a run that has been started or restarted. Reading few of them is cheaper (those
 * without accelerations, forces and energies most of all), and gives these the same bits; the others are anything.
 * `tlismni_want` adds one, or TLISMNI_ALL, and answers whether anything is read then that was not before;
 * `tlismni_want_none` leaves none. */
#define TLISMNI_ALL ((size_t)-1)
TLISMNI_API bool tlismni_want(tlismni_run *run, size_t number);
TLISMNI_API void tlismni_want_none(tlismni_run *run);

/* Go on to time `t` (s) with the present inputs, impacts included; `read`: have the channels there. */
TLISMNI_API tlismni_status tlismni_step(tlismni_run *run, double t, bool read);

/* The same up to the first contact event, if there is one before or at `t`: then `*event` is true, the present time is
 * the event's, and the event has not happened yet. `tlismni_happen`, or going on, lets it happen; `*again`: another one
 * follows at once. */
TLISMNI_API tlismni_status tlismni_step_to_event(tlismni_run *run, double t, bool *event);
TLISMNI_API tlismni_status tlismni_happen(tlismni_run *run, bool *again);
TLISMNI_API bool tlismni_event_due(const tlismni_run *run);

/* Let the inputs count now, and have the channels at the present time. */
TLISMNI_API tlismni_status tlismni_look(tlismni_run *run);

/* Where the solver's newest step ends, but at most `t`: a step is made if none goes beyond the present time, which stays.
 * Whoever wants to look, or to set inputs, at each of the solver's steps goes from one such point to the next. */
TLISMNI_API tlismni_status tlismni_next_point(tlismni_run *run, double t, double *point);

/* Derivatives of all channels at the present time: along a direction of the inputs, with coordinates, velocities and
 * contact modes held (of accelerations and forces, that is); and in time, NaN where that is not known. `room` is memory of
 * `tlismni_state_size` bytes; the run stays as it is. */
TLISMNI_API tlismni_status tlismni_derivatives(tlismni_run *run, const double *direction, double *found, void *room);
TLISMNI_API tlismni_status tlismni_rates(tlismni_run *run, double *found, void *room);

/* Events of the last call that went on: copies at most `room`, gives how many there were. A thousand or so are kept; of
 * more in one call the first are lost, though counted. */
TLISMNI_API size_t tlismni_events(tlismni_run *run, tlismni_event *events, size_t room);

/* Events since the start. */
TLISMNI_API int64_t tlismni_event_count(const tlismni_run *run);

/* Most steps of the solver in one call (the image says how many it is made with): a bound on its time. 0 is no bound. */
TLISMNI_API void tlismni_limit_steps(tlismni_run *run, int64_t steps);

/* Steps of the solver so far. */
TLISMNI_API int64_t tlismni_steps(const tlismni_run *run);

/* In words, what a status means and what to do about it. */
TLISMNI_API const char *tlismni_why(tlismni_status status);

/* --- state ------------------------------------------------------------------------------------------------------- */

/* All that decides the future of a run, inputs included. `tlismni_save` writes it to memory aligned to 8 bytes:
 * `tlismni_saved_size` bytes for the present state, `tlismni_state_size` are enough for any. Only the same run can go back to
 * it; structures of matrices that it no longer has are built again, which takes longer. `tlismni_pack` makes of what a run has
 * saved bytes for any run of the same image, in another process too (`tlismni_packed_size`); `tlismni_unpack` makes of these
 * what `run` can restore (`tlismni_state_size` bytes), and refuses bytes that are damaged or of another image. */
TLISMNI_API size_t tlismni_state_size(const tlismni_model *model);
TLISMNI_API size_t tlismni_saved_size(const tlismni_run *run);
TLISMNI_API void tlismni_save(const tlismni_run *run, void *bytes);
TLISMNI_API tlismni_status tlismni_restore(tlismni_run *run, const void *bytes);
TLISMNI_API size_t tlismni_packed_size(const void *saved);
TLISMNI_API tlismni_status tlismni_pack(const tlismni_run *run, const void *saved, void *bytes);
TLISMNI_API tlismni_status tlismni_unpack(tlismni_run *run, const void *bytes, size_t size, void *saved);

/* Digests of the sources of this library, and of its C sources: an image is of one library. */
extern TLISMNI_API const char tlismni_digest[];
TLISMNI_API const char *tlismni_c_digest(void);

#ifdef __cplusplus
}
#endif

#endif
