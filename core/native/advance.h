/* Parts of the way on that other files use. */
#ifndef TLISMNI_WAY_H
#define TLISMNI_WAY_H

#include "image.h"

/* Before anything else: can the run go on to `t`? The inputs count from now on. */
tlismni_status advance_begin(tlismni_run *run, double t);

/* Have the channels at `t`, which is no later than the time that is computed. */
tlismni_status advance_read(tlismni_run *run, double t);

/* Steps of the solver and instants with events so far. */
int64_t advance_used(const tlismni_run *run);

/* Whether events wait at the newest row. */
bool advance_any_pending(const tlismni_run *run);

/* Go on after `code`, until the goal or, to `hold`, until events are pending. `first`: steps made before; `seen`: events
 * that are counted already. */
tlismni_status advance_go_on(tlismni_run *run, int64_t code, bool hold, int64_t first, int64_t seen);

/* Let the pending events of the present time happen. */
tlismni_status advance_settle(tlismni_run *run);

/* The present time is `t`: inputs with derivatives have gone on. */
void advance_arrive(tlismni_run *run, double t);

/* What a call answers with: a failed run can only be restored. */
tlismni_status advance_end(tlismni_run *run, tlismni_status status);

#endif
