/* fmu_unused.c: calls that an FMI 3.0 library must have and this FMU has no use for: all answer with an
 * error. */
#include "fmi3.h"

#pragma GCC diagnostic ignored "-Wunused-parameter"

typedef const fmi3ValueReference *references;
typedef const char *string;
typedef const uint8_t *binary;

#define NONE(name, ...)                                                                                      \
    FMI3(fmi3Status) name(__VA_ARGS__);                                                                      \
    fmi3Status name(__VA_ARGS__) {                                                                           \
        return fmi3Error;                                                                                    \
    }
#define TYPE(name, type)                                                                                     \
    NONE(fmi3Get##name, fmi3Instance f, references r, size_t n, type *v, size_t m)                           \
    NONE(fmi3Set##name, fmi3Instance f, references r, size_t n, const type *v, size_t m)
#define INSTANCE(name, ...)                                                                                  \
    FMI3(fmi3Instance) name(__VA_ARGS__);                                                                    \
    fmi3Instance name(__VA_ARGS__) {                                                                         \
        return NULL;                                                                                         \
    }

/* Variables of other types than double. */
TYPE(Float32, float)
TYPE(Int8, int8_t)
TYPE(UInt8, uint8_t)
TYPE(Int16, int16_t)
TYPE(UInt16, uint16_t)
TYPE(Int32, int32_t)
TYPE(UInt32, uint32_t)
TYPE(Int64, int64_t)
TYPE(UInt64, uint64_t)
TYPE(Boolean, bool)
TYPE(String, string)
NONE(fmi3GetBinary, fmi3Instance f, references r, size_t n, size_t *sizes, binary *v, size_t m)
NONE(fmi3SetBinary, fmi3Instance f, references r, size_t n, const size_t *sizes, const binary *v, size_t m)

/* Clocks and events. */
NONE(fmi3GetClock, fmi3Instance f, references r, size_t n, bool *v)
NONE(fmi3SetClock, fmi3Instance f, references r, size_t n, const bool *v)
NONE(fmi3GetIntervalDecimal, fmi3Instance f, references r, size_t n, double *v, int *how)
NONE(fmi3GetIntervalFraction, fmi3Instance f, references r, size_t n, uint64_t *v, uint64_t *of, int *how)
NONE(fmi3GetShiftDecimal, fmi3Instance f, references r, size_t n, double *v)
NONE(fmi3GetShiftFraction, fmi3Instance f, references r, size_t n, uint64_t *v, uint64_t *of)
NONE(fmi3SetIntervalDecimal, fmi3Instance f, references r, size_t n, const double *v)
NONE(fmi3SetIntervalFraction, fmi3Instance f, references r, size_t n, const uint64_t *v, const uint64_t *of)
NONE(fmi3SetShiftDecimal, fmi3Instance f, references r, size_t n, const double *v)
NONE(fmi3SetShiftFraction, fmi3Instance f, references r, size_t n, const uint64_t *v, const uint64_t *of)
NONE(fmi3EvaluateDiscreteStates, fmi3Instance f)
NONE(fmi3UpdateDiscreteStates, fmi3Instance f, bool *again, bool *end, bool *nominals, bool *states,
     bool *timed, double *next_s)
NONE(fmi3EnterEventMode, fmi3Instance f)
NONE(fmi3EnterStepMode, fmi3Instance f)
NONE(fmi3ActivateModelPartition, fmi3Instance f, fmi3ValueReference clock, double time_s)

/* Derivatives, dependencies and configurations. */
NONE(fmi3GetNumberOfVariableDependencies, fmi3Instance f, fmi3ValueReference r, size_t *n)
NONE(fmi3GetVariableDependencies, fmi3Instance f, fmi3ValueReference r, size_t *at, fmi3ValueReference *of,
     size_t *of_at, int *kinds, size_t n)
NONE(fmi3GetDirectionalDerivative, fmi3Instance f, references u, size_t n, references k, size_t m,
     const double *s, size_t n_s, double *v, size_t n_v)
NONE(fmi3GetAdjointDerivative, fmi3Instance f, references u, size_t n, references k, size_t m,
     const double *s, size_t n_s, double *v, size_t n_v)
NONE(fmi3GetOutputDerivatives, fmi3Instance f, references r, size_t n, const int32_t *order, double *v,
     size_t m)
NONE(fmi3EnterConfigurationMode, fmi3Instance f)
NONE(fmi3ExitConfigurationMode, fmi3Instance f)

/* Model exchange and scheduled execution. */
INSTANCE(fmi3InstantiateModelExchange, string name, string token, string resources, bool visible, bool logs,
         void *environment, fmi3LogMessageCallback log)
INSTANCE(fmi3InstantiateScheduledExecution, string name, string token, string resources, bool visible,
         bool logs, void *environment, fmi3LogMessageCallback log, void (*update)(void), void (*lock)(void),
         void (*unlock)(void))
NONE(fmi3EnterContinuousTimeMode, fmi3Instance f)
NONE(fmi3CompletedIntegratorStep, fmi3Instance f, bool no_earlier_state, bool *event, bool *end)
NONE(fmi3SetTime, fmi3Instance f, double time_s)
NONE(fmi3SetContinuousStates, fmi3Instance f, const double *v, size_t n)
NONE(fmi3GetContinuousStateDerivatives, fmi3Instance f, double *v, size_t n)
NONE(fmi3GetEventIndicators, fmi3Instance f, double *v, size_t n)
NONE(fmi3GetContinuousStates, fmi3Instance f, double *v, size_t n)
NONE(fmi3GetNominalsOfContinuousStates, fmi3Instance f, double *v, size_t n)
NONE(fmi3GetNumberOfEventIndicators, fmi3Instance f, size_t *n)
NONE(fmi3GetNumberOfContinuousStates, fmi3Instance f, size_t *n)
