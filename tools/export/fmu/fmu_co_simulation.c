/* fmu_co_simulation.c: FMI 3.0 co-simulation: instances, variables, steps and saved states. */
#define _POSIX_C_SOURCE 200809L
#include "fmu.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static fmi3Status say(fmi3Instance fmu, fmi3Status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static fmi3Status say(fmi3Instance fmu, fmi3Status status, const char *format, ...) {
    char text[PALP_ERROR_TEXT + 128];
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    if (fmu->log && fmu->logs)
        fmu->log(fmu->environment, status, status == fmi3Discard ? "discard" : "error", text);
    return status;
}

const char *fmi3GetVersion(void) {
    return "3.0";
}

fmi3Status fmi3SetDebugLogging(fmi3Instance fmu, bool on, size_t n, const char *const *categories) {
    (void)n, (void)categories;
    fmu->logs = on;
    return fmi3OK;
}

/* ---- instances ---- */

/* The first line of a file of the resources, or nothing. */
static void first_line(const char *folder, const char *name, char *line, int room) {
    char path[PALP_PATH_MAX];
    int n = snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *from = n > 0 && n < PALP_PATH_MAX ? fopen(path, "r") : NULL;
    *line = '\0';
    if (from && fgets(line, room, from))
        line[strcspn(line, "\n")] = '\0';
    if (from)
        fclose(from);
}

/* The height, and the start of the sphere: its centre at the middle of the top. */
static bool measure(fmi3Instance fmu) {
    palp_mesh *mesh = NULL;
    palp_error error = {PALP_OK, ""};
    double low[3], high[3];
    fmu->height_m = fmu->model.height_m;
    if (fmu->model.kind == PALP_MODEL_LUMPED)
        return true;
    if (palp_model_mesh(&fmu->model, &mesh, &error))
        return say(fmu, fmi3Error, "%s", error.text) == fmi3OK;
    palp_mesh_bounds(mesh, low, high);
    for (int k = 0; k < 3; k++)
        fmu->start.value[FMU_TOOL + k] = k == 1 ? high[k] : 0.5 * (low[k] + high[k]);
    fmu->height_m = high[1] - low[1];
    palp_mesh_free(mesh);
    return true;
}

static bool load(fmi3Instance fmu, const char *token, const char *resources) {
    char path[PALP_PATH_MAX], own[128];
    palp_error error = {PALP_OK, ""};
    int n = snprintf(path, sizeof path, "%s/model.json", resources ? resources : "");
    first_line(resources ? resources : "", "token", own, sizeof own);
    if (!token || !*own || strcmp(token, own) != 0)
        return say(fmu, fmi3Error, "the instantiation token is not that of this FMU's resources") == fmi3OK;
    if (n < 0 || n >= PALP_PATH_MAX || palp_model_read(path, &fmu->model, &fmu->source, &error))
        return say(fmu, fmi3Error, "%s", *error.text ? error.text : "the resources' path is too long") ==
               fmi3OK;
    fmu->model.n_effects = 0; /* export leaves none */
    return measure(fmu);
}

fmi3Instance fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources,
                                         bool visible, bool logs, bool events, bool early_return,
                                         const fmi3ValueReference *intermediate, size_t n, void *environment,
                                         fmi3LogMessageCallback log, void (*update)(void)) {
    (void)name, (void)visible, (void)events, (void)early_return, (void)intermediate, (void)n, (void)update;
    fmi3Instance fmu = calloc(1, sizeof *fmu);
    if (!fmu)
        return NULL;
    fmu->log = log;
    fmu->logs = logs;
    fmu->environment = environment;
    if (!load(fmu, token, resources)) {
        free(fmu);
        return NULL;
    }
    fmu->now = fmu->start;
    return fmu;
}

void fmi3FreeInstance(fmi3Instance fmu) {
    if (fmu)
        palp_network_free(fmu->network);
    free(fmu);
}

static fmi3Status wants(fmi3Instance fmu, fmu_mode mode, const char *call) {
    return fmu->now.mode == mode ? fmi3OK : say(fmu, fmi3Error, "%s is not allowed in this state", call);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance fmu, bool tolerance_given, double tolerance,
                                       double start_s, bool stop_given, double stop_s) {
    (void)tolerance_given, (void)tolerance, (void)stop_given, (void)stop_s;
    if (wants(fmu, FMU_NEW, "fmi3EnterInitializationMode"))
        return fmi3Error;
    fmu->now.mode = FMU_STARTING;
    fmu->now.value[FMU_TIME] = start_s;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance fmu) {
    palp_error error = {PALP_OK, ""};
    if (wants(fmu, FMU_STARTING, "fmi3ExitInitializationMode"))
        return fmi3Error;
    palp_status status = fmu_prepare(fmu, &error);
    if (fmu->network)
        palp_network_reset(fmu->network);
    status = status ? status : fmu_begin(fmu);
    if (status)
        return say(fmu, fmi3Error, "the start: %s", *error.text ? error.text : palp_status_text(status));
    fmu->now.mode = FMU_STEPPING;
    return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance fmu) {
    if (wants(fmu, FMU_STEPPING, "fmi3Terminate"))
        return fmi3Error;
    fmu->now.mode = FMU_ENDED;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance fmu) {
    fmu->now = fmu->start;
    return fmi3OK;
}

/* ---- variables ---- */

static size_t count(const struct fmu *fmu) {
    return fmu->model.kind == PALP_MODEL_LUMPED ? FMU_LUMPED_COUNT : FMU_COUNT;
}

fmi3Status fmi3GetFloat64(fmi3Instance fmu, const fmi3ValueReference *which, size_t n, double *values,
                          size_t n_values) {
    for (size_t i = 0; i < n; i++)
        if (n != n_values || which[i] >= count(fmu))
            return say(fmu, fmi3Error, "there is no variable %lu", (unsigned long)which[i]);
    for (size_t i = 0; i < n; i++)
        values[i] = fmu->now.value[which[i]];
    return fmi3OK;
}

/* What is wrong with setting a variable; NULL = nothing. */
static const char *refused(const struct fmu *fmu, fmi3ValueReference which, double value) {
    const bool parameter = which == FMU_MAX_STEP || which == FMU_TIP_RADIUS;
    if (which >= count(fmu))
        return "is not there";
    if (which == FMU_TIME || which == FMU_FORCE || which >= FMU_TOOL_FORCE)
        return "is no input";
    if (parameter && fmu->now.mode > FMU_STARTING)
        return "is a parameter, which cannot change after the initialization";
    return !isfinite(value) || (parameter && value < 0) ? "must be a finite number, a parameter 0 or more"
                                                        : NULL;
}

fmi3Status fmi3SetFloat64(fmi3Instance fmu, const fmi3ValueReference *which, size_t n, const double *values,
                          size_t n_values) {
    for (size_t i = 0; i < n; i++) {
        const char *why = n == n_values ? refused(fmu, which[i], values[i]) : "has not one value";
        if (why)
            return say(fmu, fmi3Error, "variable %lu %s", (unsigned long)which[i], why);
    }
    for (size_t i = 0; i < n; i++)
        fmu->now.value[which[i]] = values[i];
    return fmi3OK;
}

/* ---- steps ---- */

fmi3Status fmi3DoStep(fmi3Instance fmu, double time_s, double step_s, bool no_earlier_state, bool *event,
                      bool *terminate, bool *early, double *last_s) {
    double done_s = 0;
    (void)no_earlier_state;
    *event = *terminate = *early = false;
    *last_s = fmu->now.value[FMU_TIME];
    if (wants(fmu, FMU_STEPPING, "fmi3DoStep"))
        return fmi3Error;
    if (!(step_s > 0) || !isfinite(step_s))
        return say(fmu, fmi3Error, "a step of %g s", step_s);
    palp_status status = fmu_advance(fmu, step_s, &done_s);
    *last_s = fmu->now.value[FMU_TIME] = time_s + done_s;
    if (status == PALP_ERR_ARGUMENT)
        return say(fmu, fmi3Discard,
                   "the step from %g s by %g s: the depth does not end below the height of %g m", time_s,
                   step_s, fmu->height_m);
    return status ? say(fmu, fmi3Discard, "the step from %g s by %g s: %s; try a smaller max_step", time_s,
                        step_s, palp_status_text(status))
                  : fmi3OK;
}

/* ---- saved states ---- */

static uint32_t sum(const struct fmu_state *state) { /* FNV-1a of what follows the sum itself */
    const unsigned char *at = (const unsigned char *)state + offsetof(struct fmu_state, has_network);
    const unsigned char *end = (const unsigned char *)state + state->size;
    uint32_t hash = UINT32_C(2166136261);
    for (; at < end; at++)
        hash = (hash ^ *at) * UINT32_C(16777619);
    return hash;
}

fmi3Status fmi3FreeFMUState(fmi3Instance fmu, fmi3FMUState *state) {
    (void)fmu;
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

fmi3Status fmi3GetFMUState(fmi3Instance fmu, fmi3FMUState *state) {
    const size_t more = fmu->network ? palp_network_state_size(fmu->network) : 0;
    fmi3FMUState made = calloc(1, sizeof *made + more);
    if (!made || (more > 0 && palp_network_save(fmu->network, made->network, more))) {
        free(made);
        return say(fmu, fmi3Error, "the state: out of memory");
    }
    made->size = sizeof *made + more;
    made->has_network = more > 0;
    made->values = fmu->now;
    made->sum = sum(made);
    free(*state);
    *state = made;
    return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance fmu, fmi3FMUState state) {
    palp_error error = {PALP_OK, ""};
    const fmu_values before = fmu->now;
    if (!state)
        return say(fmu, fmi3Error, "there is no state");
    fmu->now = state->values;
    palp_status status = state->has_network ? fmu_prepare(fmu, &error) : PALP_OK;
    if (!status && state->has_network)
        status = fmu->network
                     ? palp_network_restore(fmu->network, state->network, state->size - sizeof *state)
                     : PALP_ERR_ARGUMENT;
    if (status) {
        fmu->now = before;
        return say(fmu, fmi3Error, "the state: %s", *error.text ? error.text : palp_status_text(status));
    }
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance fmu, fmi3FMUState state, size_t *size) {
    (void)fmu;
    *size = state->size;
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance fmu, fmi3FMUState state, uint8_t *bytes, size_t size) {
    if (size < state->size)
        return say(fmu, fmi3Error, "the state needs %zu bytes", state->size);
    memcpy(bytes, state, state->size);
    return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance fmu, const uint8_t *bytes, size_t size, fmi3FMUState *state) {
    fmi3FMUState made = size >= sizeof *made ? malloc(size) : NULL;
    if (made)
        memcpy(made, bytes, size);
    if (!made || made->size > size || made->size < sizeof *made || made->sum != sum(made)) {
        free(made);
        return say(fmu, fmi3Error, "the bytes are no saved state of this FMU");
    }
    free(*state);
    *state = made;
    return fmi3OK;
}
