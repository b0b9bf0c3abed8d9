/* petsc_internal.h: a part of a network and PETSc's objects for it. Internal; built with PETSC=1 only. */
#ifndef PETSC_INTERNAL_H
#define PETSC_INTERNAL_H

#include "network/network_internal.h"

#include <palpate/ranks.h>
#include <petscsnes.h>

struct palp_ranks {
    MPI_Comm comm;
    int rank, count;
};

/* An ordered pair of nodes of the part without an element between them; a solid or tool needs its block. */
typedef struct part_pair {
    int32_t row, column;
} part_pair;

/* A part of a network. PETSc numbers nodes by process, with three unknowns each. Fixed axes have the equation
 * that their displacement is zero. */
typedef struct part {
    network_ranks hook; /* first, so that a pointer to it is one to the part */
    MPI_Comm comm;
    palp_network *net;   /* set at the first solution */
    size_t n_nodes;      /* of the part's mesh */
    PetscInt n_own;      /* of them, nodes that this process owns */
    unsigned char *own;  /* [n_nodes] */
    PetscInt *number;    /* [n_nodes] in PETSc's order of nodes */
    int32_t *node;       /* [n_nodes] in the whole mesh */
    int32_t *element;    /* [the part's n_elements] in the whole mesh */
    int32_t *solid;      /* [the part's solids] in the whole mesh */
    double *by_regions;  /* [the part's n_elements and solids] the hook's scales, or NULL */
    Vec x, f, sum;       /* of the unknowns: positions, minus the residual, and sums over parts */
    Vec local;           /* [3 n_nodes] of the part, also of nodes that others own */
    VecScatter exchange; /* from x to local */

    /* made at the first solution */
    Mat tangent;
    SNES snes;
    PetscScalar *value; /* [n_value] of the tangent: elements, nodes, pairs (petsc_tangent.c) */
    size_t n_value, n_pairs;
    part_pair *pair;    /* [n_pairs] sorted */
    double *node_block; /* [9 n_nodes] */

    PetscInt fresh;         /* iterations with a multigrid of the same tangent; 0 = set it up again */
    double residual, scale; /* of the last evaluation */
    bool indefinite;        /* conjugate gradients met a tangent that is not positive definite */
} part;

/* Turns a failure of PETSc into a status. */
#define TRY(call)                                                                                            \
    do {                                                                                                     \
        if ((call) != 0)                                                                                     \
            return PALP_ERR_NO_MEMORY;                                                                       \
    } while (0)
/* In PETSc's callbacks, which return PETSc's codes. */
#define PASS(call)                                                                                           \
    do {                                                                                                     \
        PetscErrorCode code_ = (call);                                                                       \
        if (code_)                                                                                           \
            return code_;                                                                                    \
    } while (0)

/* ---- petsc_partition.c ---- */

/* The process that has each node, owner[n_nodes], by PETSc's default partitioner (PT-Scotch in Debian) on the
 * graph of elements. All processes have the whole mesh and get the same owners. */
PetscErrorCode partition_nodes(const palp_ranks *ranks, const palp_mesh *mesh, int32_t *owner);

/* number[n]: nodes ordered by process, then by index. */
PetscErrorCode number_nodes(const int32_t *owner, size_t n, int count, PetscInt *number);

/* ---- petsc_exchange.c ---- */

/* The calls of network_ranks.h. */
void part_complete(network_ranks *ranks, size_t components, double *values);
void part_sum(network_ranks *ranks, int n, double *values);
double part_largest(network_ranks *ranks, double value);

/* Values of x at the part's nodes, into p->local. */
PetscErrorCode part_fetch(part *p, Vec x);

/* The worst status of all processes; error is set where it comes from another process. */
palp_status part_agree(MPI_Comm comm, palp_status status, palp_error *error);

/* ---- petsc_tangent.c ---- */

/* Makes the tangent with its pattern and with the rigid-body motions, the near null space of the
 * multigrid. */
palp_status part_make_tangent(part *p);

/* Writes the values of the last evaluation. */
PetscErrorCode part_assemble(part *p);

/* ---- petsc_newton.c ---- */

palp_status part_newton(network_ranks *ranks, palp_network *net, palp_step_info *info);
palp_status part_factor(network_ranks *ranks, palp_network *net);
void part_solve(network_ranks *ranks, palp_network *net, double *x);

#endif
