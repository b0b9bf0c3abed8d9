/* ranks_none.c: the functions of a library without PETSc. */
#include <palpate/ranks.h>

#include "base/file.h"

static palp_status refuse(palp_error *error) {
    return palp_error_set(
        error, PALP_ERR_UNSUPPORTED,
        "this palpate was built without PETSc, which a network over several processes needs "
        "(make PETSC=1)");
}

bool palp_ranks_built(void) {
    return false;
}

palp_status palp_ranks_start(palp_ranks **ranks, palp_error *error) {
    return ranks ? refuse(error) : palp_error_null(error);
}

void palp_ranks_finish(palp_ranks *ranks) {
    (void)ranks;
}

palp_status palp_ranks_agree(const palp_ranks *ranks, palp_status status, palp_error *error) {
    (void)ranks, (void)error;
    return status;
}

int palp_ranks_rank(const palp_ranks *ranks) {
    (void)ranks;
    return 0;
}

int palp_ranks_count(const palp_ranks *ranks) {
    (void)ranks;
    return 1;
}

palp_status palp_ranks_network(palp_ranks *ranks, const palp_model *model, const palp_mesh *mesh,
                               size_t n_supports, const palp_support *supports,
                               const palp_network_settings *settings, bool tools, palp_network **network,
                               palp_error *error) {
    (void)mesh, (void)n_supports, (void)supports, (void)settings, (void)tools;
    return ranks && model && network ? refuse(error) : palp_error_null(error);
}

palp_status palp_ranks_save(const palp_network *network, const char *path, size_t n, const double *more,
                            palp_error *error) {
    return network && path && (n == 0 || more) ? refuse(error) : palp_error_null(error);
}

palp_status palp_ranks_restore(palp_network *network, const char *path, size_t *n, double **more,
                               palp_error *error) {
    return network && path && n && more ? refuse(error) : palp_error_null(error);
}
