/* simulate_ranks.c: palpate simulate --ranks: a network over the processes that mpirun starts. */
#define _XOPEN_SOURCE 700
#include "simulate.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char NAME[] = "simulate";

/* Did mpirun or srun start this process? */
static bool is_started_by_mpi(void) {
    static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK"};
    bool found = false;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        found = found || getenv(names[i]);
    return found;
}

/* Becomes mpirun with this command; returns only if that is not possible. */
static int become_mpirun(int argc, char **argv, const simulate_options *o) {
    enum { BEFORE = 4 };
    char self[CLI_PATH_MAX], count[32];
    const char **all = calloc((size_t)argc + BEFORE + 1, sizeof *all);
    ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
    if (!all || n < 0) {
        free(all);
        return cli_failure(NAME, "mpirun cannot be started: %s", strerror(errno));
    }
    self[n] = '\0';
    snprintf(count, sizeof count, "%zu", o->ranks);
    const char *const before[BEFORE] = {"mpirun", "-n", count, self};
    memcpy(all, before, sizeof before);
    memcpy(all + BEFORE, argv, (size_t)argc * sizeof *argv);
    execvp(all[0], (char *const *)all);
    free(all);
    return cli_failure(NAME, "mpirun cannot be started: %s; --ranks needs MPI (Debian: openmpi-bin)",
                       strerror(errno));
}

/* One process speaks for all. */
static int keep_quiet(void) {
    int null = open("/dev/null", O_WRONLY);
    bool ok = null >= 0 && dup2(null, STDOUT_FILENO) >= 0 && dup2(null, STDERR_FILENO) >= 0;
    return ok ? CLI_OK : cli_failure(NAME, "/dev/null: %s", strerror(errno));
}

static int check(const simulate_options *o) {
    if (o->ranks == 0)
        return o->checkpoint || o->restart
                   ? cli_usage_error(NAME, "--checkpoint and --restart go with --ranks")
                   : CLI_OK;
    const char *option = o->band          ? "band"
                         : o->branch == 1 ? "branch stable"
                         : o->solver > 0  ? "solver"
                                          : NULL;
    if (option)
        return cli_usage_error(NAME, "--%s does not go with --ranks; run it in one process", option);
    if ((o->checkpoint || o->restart) && !(o->dt_ms > 0 && o->tip != 1))
        return cli_usage_error(NAME,
                               "--checkpoint and --restart need the fixed steps of --dt-ms, and the plate");
    return CLI_OK;
}

int simulate_ranks_start(int argc, char **argv, const simulate_options *o, simulation *s) {
    palp_error error = {PALP_OK, ""};
    int code = check(o);
    if (code || o->ranks == 0)
        return code;
    if (palp_ranks_built() && !is_started_by_mpi() && o->ranks > 1)
        return become_mpirun(argc, argv, o);
    palp_status status = palp_ranks_start(&s->ranks, &error);
    if (status)
        return cli_status(NAME, status, &error);
    if ((size_t)palp_ranks_count(s->ranks) != o->ranks)
        code = cli_usage_error(NAME, "--ranks %zu, but there are %d processes", o->ranks,
                               palp_ranks_count(s->ranks));
    return code || palp_ranks_rank(s->ranks) == 0 ? code : keep_quiet();
}

int simulate_ranks_agree(const simulate_options *o, const simulation *s, int code) {
    if (!s->ranks)
        return code;
    if (code == CLI_OK && (s->reduced || s->model.kind != PALP_MODEL_NETWORK))
        code = cli_usage_error(NAME, "--ranks divides a network; %s is a %s model", o->model,
                               s->reduced ? "reduced" : "lumped");
    if (code == CLI_OK && s->model.n_effects > 0)
        code = cli_failure(NAME, "%s: --ranks cannot have the effect %s; run it in one process", o->model,
                           palp_effect_look_up(s->model.effects[0].id)->id);
    if (code == CLI_OK && s->model.n_free > 0)
        code = cli_failure(NAME, "%s: --ranks cannot have free terms; run it in one process", o->model);
    palp_status status = palp_ranks_agree(s->ranks, code ? PALP_ERR_INPUT : PALP_OK, NULL);
    return code || !status ? code : cli_failure(NAME, "another process failed");
}

palp_status simulate_ranks_save(const simulate_options *o, const simulation *s, palp_error *error) {
    const record *c = &s->curve;
    double *all = malloc((3 * c->n + 1) * sizeof *all);
    palp_status status = palp_ranks_agree(s->ranks, all ? PALP_OK : PALP_ERR_NO_MEMORY, error);
    for (size_t i = 0; i < c->n && !status; i++) {
        all[3 * i] = c->time_s[i];
        all[3 * i + 1] = c->depth_m[i];
        all[3 * i + 2] = c->force_N[i];
    }
    if (!status)
        status = palp_ranks_save(s->network, o->checkpoint, 3 * c->n, all, error);
    free(all);
    return status;
}

palp_status simulate_ranks_restore(const simulate_options *o, simulation *s, palp_error *error) {
    double *all = NULL;
    size_t n = 0;
    palp_status status = palp_ranks_restore(s->network, o->restart, &n, &all, error);
    for (size_t i = 0; i + 2 < n && !status; i += 3)
        status = record_add(&s->curve, all[i], all[i + 1], all[i + 2]);
    free(all);
    const size_t last = s->curve.n - 1;
    if (!status && s->curve.n > 0 && s->path.depth_m &&
        fabs(palp_path_at(&s->path, s->curve.time_s[last]) - s->curve.depth_m[last]) > 1e-9 * s->height_m) {
        status = PALP_ERR_INPUT;
        *error = (palp_error){.status = status};
        snprintf(error->text, sizeof error->text, "%s: is the state of another motion of the plate",
                 o->restart);
    }
    return status;
}
