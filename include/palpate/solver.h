/* solver.h: how a network's linear systems are solved. Stable. */
#ifndef PALPATE_SOLVER_H
#define PALPATE_SOLVER_H

typedef enum palp_solver {
    PALP_SOLVER_AUTO,       /* the cheapest by estimated flops */
    PALP_SOLVER_BAND,       /* block band L D L' with BLAS */
    PALP_SOLVER_SIMPLICIAL, /* CHOLMOD simplicial L D L' (LGPL) */
    PALP_SOLVER_SUPERNODAL  /* CHOLMOD supernodal; built with GPL=1 only */
} palp_solver;

#endif
