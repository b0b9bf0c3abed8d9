/* ranks.h: one network over several processes, for millions of nodes. May change. mpirun starts the
 * processes; PETSc solves. All processes make the same calls in the same order, and get the same forces and
 * statuses. A library built without PETSc (make PETSC=1) returns ERR_UNSUPPORTED. */
#ifndef PALPATE_RANKS_H
#define PALPATE_RANKS_H

#include <palpate/network.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct palp_ranks palp_ranks; /* opaque; palp_ranks_finish */

/* Was the library built with PETSc? */
PALP_API bool palp_ranks_built(void);

/* Starts MPI and PETSc, which reads its own options from the environment (PETSC_OPTIONS); once in a process.
 * Without mpirun there is one process. The caller owns *ranks. ERR_UNSUPPORTED: built without PETSc;
 * ERR_INPUT: MPI or PETSc did not start. error may be NULL. */
PALP_API palp_status palp_ranks_start(palp_ranks **ranks, palp_error *error);

/* Ends both, after the networks over these processes were freed. NULL is fine. */
PALP_API void palp_ranks_finish(palp_ranks *ranks);

PALP_API int palp_ranks_rank(const palp_ranks *ranks);  /* number of this process, from 0; NULL: 0 */
PALP_API int palp_ranks_count(const palp_ranks *ranks); /* number of processes; NULL: 1 */

/* The worst status of all processes, so that all go on or all stop. error, unless NULL, gets a line where the
 * process' own is PALP_OK. NULL for ranks: status as it is. */
PALP_API palp_status palp_ranks_agree(const palp_ranks *ranks, palp_status status, palp_error *error);

/* The network of a network model, of which each process has a part, as PETSc divides the graph of its
 * elements. Arguments as in palp_network_from_model. Each process makes the whole mesh and keeps its part.
 * With tools, each part also has all nodes of the surface, on which palp_network_enable_tools works without
 * subdivisions; palp_network_contacts names no regions then. The part can be stepped and run, and written by
 * palp_vtu_add (one file for each process). Positions, elements and the mesh are those of the part; forces
 * and depths are of the whole. Newton's method is PETSc's (SNES, line search on the residual), linear systems
 * are solved by conjugate gradients with algebraic multigrid (GAMG). Stability is assessed only where
 * conjugate gradients find an indefinite tangent. ERR_UNSUPPORTED, with the name of the feature in error:
 * effects, regions with a material or fibres of their own, density, PALP_BRANCH_STABLE. Cutting, ties,
 * contact of tissue, real time and reduction return ERR_UNSUPPORTED too. */
PALP_API palp_status palp_ranks_network(palp_ranks *ranks, const palp_model *model, const palp_mesh *mesh,
                                        size_t n_supports, const palp_support *supports,
                                        const palp_network_settings *settings, bool tools,
                                        palp_network **network, palp_error *error);

/* Writes the committed state of such a network without tools, in the order of the whole mesh. It also writes
 * n numbers of the caller, the same in all processes. The file gets a temporary name first and is renamed.
 * restore reads it into the same network over any number of processes; *more is malloc'ed, for the caller to
 * free. ERR_FILE; ERR_INPUT: the file is no such state, or another network's; ERR_UNSUPPORTED: tools,
 * PALP_SEDEF2008, a network that is not in parts. After a failed restore the network is at rest. Over several
 * processes a disk that fills while the file is written ends them all. */
PALP_API palp_status palp_ranks_save(const palp_network *network, const char *path, size_t n,
                                     const double *more, palp_error *error);
PALP_API palp_status palp_ranks_restore(palp_network *network, const char *path, size_t *n, double **more,
                                        palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
