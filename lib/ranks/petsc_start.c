/* petsc_start.c: MPI and PETSc, from their start to their end. */
#include "petsc_internal.h"

#include "base/file.h"

#include <stdlib.h>

bool palp_ranks_built(void) {
    return true;
}

/* PETSc prints nothing and leaves signals alone; failures come back as codes. */
static PetscErrorCode start_petsc(void) {
    PASS(PetscOptionsSetValue(NULL, "-no_signal_handler", "true"));
    PASS(PetscInitialize(NULL, NULL, NULL, NULL));
    return PetscPushErrorHandler(PetscReturnErrorHandler, NULL);
}

palp_status palp_ranks_start(palp_ranks **ranks, palp_error *error) {
    if (!ranks)
        return palp_error_null(error);
    palp_ranks *made = calloc(1, sizeof *made);
    if (!made)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    if (start_petsc()) {
        free(made);
        return palp_error_set(error, PALP_ERR_INPUT, "MPI or PETSc did not start");
    }
    made->comm = PETSC_COMM_WORLD;
    MPI_Comm_rank(made->comm, &made->rank);
    MPI_Comm_size(made->comm, &made->count);
    *ranks = made;
    return PALP_OK;
}

void palp_ranks_finish(palp_ranks *ranks) {
    if (ranks)
        PetscFinalize();
    free(ranks);
}

palp_status palp_ranks_agree(const palp_ranks *ranks, palp_status status, palp_error *error) {
    return ranks ? part_agree(ranks->comm, status, error) : status;
}

int palp_ranks_rank(const palp_ranks *ranks) {
    return ranks ? ranks->rank : 0;
}

int palp_ranks_count(const palp_ranks *ranks) {
    return ranks ? ranks->count : 1;
}
