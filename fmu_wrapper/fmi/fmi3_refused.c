/* The functions of FMI 3.0 that our FMUs have not, as their model descriptions say: types of variables that they do not use,
 * clocks, structural parameters, model exchange, scheduled execution. Each is there, since importers look up all of them, and
 * answers Error with a line in the log. */

#include "functions.h"

/* nothing is done with what they are given */
#if defined __GNUC__ || defined __clang__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

typedef Slave *fmi3Instance;
typedef uint32_t fmi3ValueReference;
typedef int fmi3Status;
typedef int fmi3IntervalQualifier;
typedef int fmi3DependencyKind;

static fmi3Status refuse(fmi3Instance c, const char *function, const char *why) {
    return IF(slave_host(c), host_error(slave_host(c), function, "UnavailableError: %s", why));
}

#define REFUSED(name, ...)                                 \
    EXPORT fmi3Status name(fmi3Instance c, __VA_ARGS__) {  \
        return refuse(c, __func__, WHY);                   \
    }
#define REFUSED_PLAIN(name)                \
    EXPORT fmi3Status name(fmi3Instance c) { \
        return refuse(c, __func__, WHY);   \
    }
#define REFERENCES const fmi3ValueReference vr[], size_t n

/* types */

#define WHY "this FMU has no variables of this type: modelDescription.xml says which types it has"

REFUSED(fmi3GetFloat32, REFERENCES, float value[], size_t values)
REFUSED(fmi3SetFloat32, REFERENCES, const float value[], size_t values)
REFUSED(fmi3GetInt8, REFERENCES, int8_t value[], size_t values)
REFUSED(fmi3SetInt8, REFERENCES, const int8_t value[], size_t values)
REFUSED(fmi3GetUInt8, REFERENCES, uint8_t value[], size_t values)
REFUSED(fmi3SetUInt8, REFERENCES, const uint8_t value[], size_t values)
REFUSED(fmi3GetInt16, REFERENCES, int16_t value[], size_t values)
REFUSED(fmi3SetInt16, REFERENCES, const int16_t value[], size_t values)
REFUSED(fmi3GetUInt16, REFERENCES, uint16_t value[], size_t values)
REFUSED(fmi3SetUInt16, REFERENCES, const uint16_t value[], size_t values)
REFUSED(fmi3GetUInt32, REFERENCES, uint32_t value[], size_t values)
REFUSED(fmi3SetUInt32, REFERENCES, const uint32_t value[], size_t values)
REFUSED(fmi3GetUInt64, REFERENCES, uint64_t value[], size_t values)
REFUSED(fmi3SetUInt64, REFERENCES, const uint64_t value[], size_t values)
REFUSED(fmi3GetBinary, REFERENCES, size_t sizes[], const uint8_t *value[], size_t values)
REFUSED(fmi3SetBinary, REFERENCES, const size_t sizes[], const uint8_t *const value[], size_t values)

/* clocks */

#undef WHY
#define WHY "this FMU has no clocks"

REFUSED(fmi3GetClock, REFERENCES, bool value[])
REFUSED(fmi3SetClock, REFERENCES, const bool value[])
REFUSED(fmi3GetIntervalDecimal, REFERENCES, double interval[], fmi3IntervalQualifier qualifier[])
REFUSED(fmi3GetIntervalFraction, REFERENCES, uint64_t counter[], uint64_t resolution[],
        fmi3IntervalQualifier qualifier[])
REFUSED(fmi3GetShiftDecimal, REFERENCES, double shift[])
REFUSED(fmi3GetShiftFraction, REFERENCES, uint64_t counter[], uint64_t resolution[])
REFUSED(fmi3SetIntervalDecimal, REFERENCES, const double interval[])
REFUSED(fmi3SetIntervalFraction, REFERENCES, const uint64_t counter[], const uint64_t resolution[])
REFUSED(fmi3SetShiftDecimal, REFERENCES, const double shift[])
REFUSED(fmi3SetShiftFraction, REFERENCES, const uint64_t counter[], const uint64_t resolution[])
REFUSED(fmi3ActivateModelPartition, fmi3ValueReference clock, double time)

/* structure */

#undef WHY
#define WHY "this FMU has no structural parameters, and no dependencies per element"

REFUSED_PLAIN(fmi3EnterConfigurationMode)
REFUSED_PLAIN(fmi3ExitConfigurationMode)
REFUSED(fmi3GetNumberOfVariableDependencies, fmi3ValueReference vr, size_t *count)
REFUSED(fmi3GetVariableDependencies, fmi3ValueReference dependent, size_t element[], fmi3ValueReference independent[],
        size_t independent_element[], fmi3DependencyKind kind[], size_t count)

/* model exchange */

#undef WHY
#define WHY "providesEvaluateDiscreteStates = false: use fmi3UpdateDiscreteStates"

REFUSED_PLAIN(fmi3EvaluateDiscreteStates)

#undef WHY
#define WHY "this FMU does co-simulation only"

REFUSED_PLAIN(fmi3EnterContinuousTimeMode)
REFUSED(fmi3CompletedIntegratorStep, bool no_set_state, bool *enter_event_mode, bool *terminate)
REFUSED(fmi3SetTime, double time)
REFUSED(fmi3SetContinuousStates, const double state[], size_t n)
REFUSED(fmi3GetContinuousStateDerivatives, double derivative[], size_t n)
REFUSED(fmi3GetEventIndicators, double indicator[], size_t n)
REFUSED(fmi3GetContinuousStates, double state[], size_t n)
REFUSED(fmi3GetNominalsOfContinuousStates, double nominal[], size_t n)
REFUSED(fmi3GetNumberOfEventIndicators, size_t *count)
REFUSED(fmi3GetNumberOfContinuousStates, size_t *count)
