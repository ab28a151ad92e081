/* The functions of FMI 3.0 that this FMU has not, as its model description says. Each answers Error with a line in the
 * log; `refuse` (fmi3_calls.py) knows why. */

#include "forward.h"

#define REFUSED(name, ...)                               \
    EXPORT fmi3Status name(Instance *c, __VA_ARGS__) {   \
        FORWARD(c, "refuse", "(s)", #name);              \
    }
#define REFUSED_PLAIN(name)                              \
    EXPORT fmi3Status name(Instance *c) {                \
        FORWARD(c, "refuse", "(s)", #name);              \
    }

#include "fmi3_refused.h"
