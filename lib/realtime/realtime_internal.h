/* realtime_internal.h: inside of palp_network_step_within, shared by its own files. */
#ifndef REALTIME_INTERNAL_H
#define REALTIME_INTERNAL_H

#include "solve/multigrid.h"
#include "network/network_internal.h"

#include <palpate/realtime.h>

typedef struct refresh_thread refresh_thread;

typedef enum refresh_stage { REFRESH_COPY, REFRESH_MAKE } refresh_stage;

/* Seconds that parts of a tick take, as lately measured. */
typedef struct realtime_times {
    double evaluation, correction, rest;
} realtime_times;

struct network_realtime {
    palp_realtime_settings settings;
    multigrid *mg;
    double *r, *z, *p, *q; /* [3 n_nodes] conjugate gradients, 0 at held axes */
    double *move;          /* [3 n_nodes] correction */
    double *adjoint;       /* [3 n_nodes] dx / d depth, the motion at held axes */
    bool driven;           /* some axis is: there is an adjoint */
    double adjoint_error;  /* of it, in the norm of the tangent */
    double error_ratio;    /* error in that norm over |residual|, where it was last known */
    double remembered;     /* error of the force that is in the arms' history, N */
    double contraction;    /* what the last tick left of its first residual */

    load_coupling *coupling; /* [MULTIGRID_COUPLINGS] scratch, */
    multigrid_coupling *touching; /* likewise */
    refresh_stage stage;   /* of the next factor */
    size_t at;             /* elements copied, or pieces made */
    double piece;          /* work on it in a tick */
    bool definite;         /* it is made without what can make it indefinite */
    bool used_definite;    /* so was the one in use */
    int adjoint_due;       /* corrections of the adjoint */
    refresh_thread *thread; /* makes it, or NULL */

    realtime_times times;
};

/* A factor and an adjoint at once, of the committed state (realtime.c). */
palp_status realtime_begin(palp_network *net);

/* ---- realtime_solve.c ---- */

/* Preconditioned conjugate gradients on the tangent of the last evaluation from rt->r, at most limit corrections or
 * until the residual falls to share of its norm. The correction is in rt->move; returns how many it took. */
size_t realtime_solve(palp_network *net, size_t limit, double share);

/* One correction of the adjoint. */
void realtime_improve_adjoint(palp_network *net);

double realtime_dot(const double *a, const double *b, size_t n);

/* ---- realtime_refresh.c ---- */

/* Brings what the load adds to the tangent up to date in the factor in use, as far as can be. */
void realtime_touch(palp_network *net);

/* A factor at once, from the last evaluation. */
palp_status realtime_refresh_now(palp_network *net);

/* A piece of the next factor; true if it came into use. */
bool realtime_refresh(palp_network *net);

/* ---- realtime_thread.c ---- */

palp_status refresh_thread_create(multigrid *mg, refresh_thread **out);
void refresh_thread_free(refresh_thread *t); /* NULL is fine; waits */

/* Makes what multigrid_begin began. */
void refresh_thread_start(refresh_thread *t);

/* Is it made? *status: of the making. Does not wait. */
bool refresh_thread_done(refresh_thread *t, palp_status *status);
void refresh_thread_wait(refresh_thread *t);

double realtime_clock(void); /* s, monotonic */

#endif
