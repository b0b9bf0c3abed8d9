/* fmi3.h: the part of FMI 3.0.2 (fmi-standard.org) that the FMU uses, written from the standard's text. */
#ifndef PALPATE_FMI3_H
#define PALPATE_FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FMI3(type) __attribute__((visibility("default"))) type

typedef struct fmu *fmi3Instance;
typedef struct fmu_state *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef enum fmi3Status { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;

/* Receives the importer's own pointer, a status, a category and a message. */
typedef void (*fmi3LogMessageCallback)(void *environment, fmi3Status status, const char *category,
                                       const char *message);

/* ---- fmu_co_simulation.c ---- */

FMI3(const char *) fmi3GetVersion(void);
FMI3(fmi3Status) fmi3SetDebugLogging(fmi3Instance fmu, bool on, size_t n, const char *const *categories);
FMI3(fmi3Instance)
fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                            bool logs, bool events, bool early_return, const fmi3ValueReference *intermediate,
                            size_t n, void *environment, fmi3LogMessageCallback log, void (*update)(void));
FMI3(void) fmi3FreeInstance(fmi3Instance fmu);
FMI3(fmi3Status)
fmi3EnterInitializationMode(fmi3Instance fmu, bool tolerance_given, double tolerance, double start_s,
                            bool stop_given, double stop_s);
FMI3(fmi3Status) fmi3ExitInitializationMode(fmi3Instance fmu);
FMI3(fmi3Status) fmi3Terminate(fmi3Instance fmu);
FMI3(fmi3Status) fmi3Reset(fmi3Instance fmu);
FMI3(fmi3Status)
fmi3GetFloat64(fmi3Instance fmu, const fmi3ValueReference *which, size_t n, double *values, size_t n_values);
FMI3(fmi3Status)
fmi3SetFloat64(fmi3Instance fmu, const fmi3ValueReference *which, size_t n, const double *values,
               size_t n_values);
FMI3(fmi3Status)
fmi3DoStep(fmi3Instance fmu, double time_s, double step_s, bool no_earlier_state, bool *event,
           bool *terminate, bool *early, double *last_s);
FMI3(fmi3Status) fmi3GetFMUState(fmi3Instance fmu, fmi3FMUState *state);
FMI3(fmi3Status) fmi3SetFMUState(fmi3Instance fmu, fmi3FMUState state);
FMI3(fmi3Status) fmi3FreeFMUState(fmi3Instance fmu, fmi3FMUState *state);
FMI3(fmi3Status) fmi3SerializedFMUStateSize(fmi3Instance fmu, fmi3FMUState state, size_t *size);
FMI3(fmi3Status) fmi3SerializeFMUState(fmi3Instance fmu, fmi3FMUState state, uint8_t *bytes, size_t size);
FMI3(fmi3Status)
fmi3DeserializeFMUState(fmi3Instance fmu, const uint8_t *bytes, size_t size, fmi3FMUState *state);

#endif
