/* The functions of FMI 3.0 that an FMU without Python has not, as its model description says: those that no FMU of ours
 * has. Each answers Error with a line in the log. */

#include "slave.h"

#define REFUSED(name, ...)                          \
    EXPORT fmi3Status name(Slave *c, __VA_ARGS__) { \
        return slave_refuses(c, #name);             \
    }
#define REFUSED_PLAIN(name)             \
    EXPORT fmi3Status name(Slave *c) {  \
        return slave_refuses(c, #name); \
    }

#include "../shim/fmi3_refused.h"
