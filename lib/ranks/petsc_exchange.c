/* petsc_exchange.c: the exchange of values between the parts of a network. */
#include "petsc_internal.h"

#include "base/file.h"

PetscErrorCode part_fetch(part *p, Vec x) {
    PASS(VecScatterBegin(p->exchange, x, p->local, INSERT_VALUES, SCATTER_FORWARD));
    return VecScatterEnd(p->exchange, x, p->local, INSERT_VALUES, SCATTER_FORWARD);
}

static PetscErrorCode add_up(part *p, size_t components, double *values) {
    PetscScalar *at;
    PASS(VecGetArray(p->local, &at));
    for (size_t i = 0; i < 3 * p->n_nodes; i++)
        at[i] = i % 3 < components ? values[components * (i / 3) + i % 3] : 0.0;
    PASS(VecRestoreArray(p->local, &at));
    PASS(VecSet(p->sum, 0.0));
    PASS(VecScatterBegin(p->exchange, p->local, p->sum, ADD_VALUES, SCATTER_REVERSE));
    PASS(VecScatterEnd(p->exchange, p->local, p->sum, ADD_VALUES, SCATTER_REVERSE));
    PASS(part_fetch(p, p->sum));
    PASS(VecGetArray(p->local, &at));
    for (size_t i = 0; i < 3 * p->n_nodes; i++)
        if (i % 3 < components)
            values[components * (i / 3) + i % 3] = at[i];
    return VecRestoreArray(p->local, &at);
}

/* After a failed message the processes are no longer in step, so the program ends. */
void part_complete(network_ranks *ranks, size_t components, double *values) {
    part *p = (part *)ranks;
    if (add_up(p, components, values))
        MPI_Abort(p->comm, 1);
}

void part_sum(network_ranks *ranks, int n, double *values) {
    MPI_Allreduce(MPI_IN_PLACE, values, n, MPI_DOUBLE, MPI_SUM, ((part *)ranks)->comm);
}

double part_largest(network_ranks *ranks, double value) {
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, ((part *)ranks)->comm);
    return value;
}

palp_status part_agree(MPI_Comm comm, palp_status status, palp_error *error) {
    int worst = (int)status;
    MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_INT, MPI_MAX, comm);
    if (worst != (int)status)
        palp_error_set(error, (palp_status)worst, "another process: %s",
                       palp_status_text((palp_status)worst));
    return (palp_status)worst;
}
