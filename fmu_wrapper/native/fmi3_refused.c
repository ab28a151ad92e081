/* The functions of FMI 3.0 that an FMU without Python has not, as its model description says: those that no FMU of ours
 * has, and derivatives. Each answers Error with a line in the log. */

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

#define OF_KNOWNS                                                                                                       \
    const fmi3ValueReference unknown[], size_t unknowns, const fmi3ValueReference known[], size_t knowns,               \
        const double seed[], size_t seeds, double sensitivity[], size_t sensitivities

REFUSED(fmi3GetDirectionalDerivative, OF_KNOWNS)
REFUSED(fmi3GetAdjointDerivative, OF_KNOWNS)
REFUSED(fmi3GetOutputDerivatives, REFERENCES, const int32_t order[], double value[], size_t values)
