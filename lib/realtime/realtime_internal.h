/* realtime_internal.h: inside of a palp_realtime, shared by its own files. */
#ifndef REALTIME_INTERNAL_H
#define REALTIME_INTERNAL_H

#include "base/arena.h"
#include "network/network_internal.h"
#include "solve/multigrid.h"

#include <palpate/realtime.h>

typedef struct refresh_thread refresh_thread;

/* The tetrahedra are looked at in so many parts, one a tick; and so are the blocks of terms on all nodes. */
enum { REALTIME_PARTS = 16 };

/* Of a tick's corrections, that are kept where tools touch. */
enum { REALTIME_DIRECTIONS = 12 };

typedef enum refresh_stage { REFRESH_DUE, REFRESH_MAKE } refresh_stage;

/* Seconds that parts of a tick take, as lately measured. */
typedef struct realtime_times {
    double evaluation, correction, rest;
} realtime_times;

struct palp_realtime {
    arena memory;
    palp_network *net; /* the caller's */
    palp_realtime_settings settings;
    multigrid *mg;
    double *r, *z, *p, *q;               /* [3 n_nodes] conjugate gradients, 0 at fixed axes */
    double *move;                        /* [3 n_nodes] correction */
    double *direction, *inner, *tangent; /* [3 n_nodes * REALTIME_DIRECTIONS], or NULL: no tools. Directions
                              of this tick's corrections, each of length 1 in the norm of the factor; the
                              tissue's tangent, and all of it, times them */
    double curvature[REALTIME_DIRECTIONS][REALTIME_DIRECTIONS]; /* [j][i]: direction i times tangent j */
    size_t n_directions;
    double *adjoint;     /* [3 n_nodes] dx / d depth, the motion at fixed axes */
    double *weight;      /* [n_nodes] stiffness of what presses on each node from outside, N/m */
    uint32_t *run_place; /* [runs] as network_blocks has it, or NULL */
    float *element;  /* [n_floats] the elements' blocks at the last evaluation with the tangent, as rt->mg has
                        them */
    bool fresh;      /* that was the last evaluation */
    bool kept;       /* it left strain, force and history in the network */
    bool indefinite; /* in this tick the tangent was found not to be positive definite */
    bool idle, near; /* the last tick made no correction; but was near to one */
    double *adjoint_r, *adjoint_z; /* [3 n_nodes] of a correction of the adjoint on its way */
    double *tissue;      /* [3 n_nodes] forces of the elements in the committed state, N, where tools touch */
    float *adjoint_half; /* [multigrid_half_size] between the halves of its cycle */
    bool driven;         /* some axis is: there is an adjoint */
    bool filled;         /* there are terms on all nodes */
    double *adjoint_at[2]; /* [3 n_nodes] where the nodes were when the error of the adjoint in use was found;
                              of the correction on its way */
    double adjoint_error;  /* of it where that is, in the norm of the tangent; */
    double adjoint_rate;   /* it grows by so much for each m from there, */
    double adjoint_far;    /* of which that many are gone, by all nodes as one vector, */
    double adjoint_farthest; /* at most so far, */
    double adjoint_found;    /* and so many where the correction on its way began */
    double forgets; /* error of the force by what the arms forget in a tick, over what they leak and the error
                       of the positions in the norm of the tangent */
    double doubt;   /* error in the norm of the tangent over the one that the factor tells, at most; 1 = it is
                       the tangent's */
    double error_ratio; /* error in that norm over |residual|, where it was last known */
    double remembered;  /* error of the force that is in the arms' history, N */
    double anchored;    /* error of the force that is in where friction's springs start from, N */
    double guessed;     /* residual of the last tick's first guess, N */
    double contraction; /* what the last tick left of its first residual */
    size_t part;        /* of the tetrahedra that the next tick looks at */
    size_t inverted[REALTIME_PARTS]; /* of each part */
    size_t resets;                   /* of the network, that the factor belongs to */

    multigrid_coupling *touching;   /* [MULTIGRID_COUPLINGS] scratch */
    refresh_stage stage;            /* of the next factor */
    size_t at;                      /* ticks that it was due, or pieces made */
    size_t gathered;                /* parts of the blocks of terms on all nodes that it has */
    double piece;                   /* work on it in a tick */
    bool definite;                  /* it is made without what can make it indefinite */
    bool used_definite;             /* so was the one in use */
    int adjoint_due, adjoint_parts; /* parts of a correction of the adjoint that are left; all, fewer where
                                       there are no arms */
    refresh_thread *thread;         /* makes it, or NULL */

    realtime_times times;
};

/* ---- realtime_solve.c ---- */

/* Finds where the runs of elements go in rt->element, if each stands together there. */
palp_status realtime_place_runs(palp_realtime *rt);

/* As network_evaluate; with the tangent: the elements' blocks into rt->element. trial: a correction follows,
 * so that strain, force and history need not be kept. */
bool realtime_evaluate(palp_realtime *rt, bool tangent, bool trial);

/* q = tangent of the last evaluation times p on the free axes, 0 on the others. In single precision: what is
 * left of a residual by corrections is evaluated anew before it is judged. Without what is not symmetric. */
void realtime_tangent_times(palp_realtime *rt, const double *p, double *q);

/* The same without what tools and hands add; and that, added to q, whole: with what is not symmetric. */
void realtime_tissue_times(palp_realtime *rt, const double *p, double *q);
void realtime_add_touching(const palp_realtime *rt, bool whole, const double *p, double *q);

/* rt->move: downhill along rt->z, but not far. */
void realtime_move_a_little(palp_realtime *rt);

/* Preconditioned conjugate gradients on the tangent of the last evaluation from rt->r, at most limit
 * corrections or until the residual falls to share of its norm, or the error of the positions in the norm of
 * the tangent below enough. The correction is in rt->move; returns how many it took. */
size_t realtime_solve(palp_realtime *rt, size_t limit, double share, double enough);

/* ---- realtime_adjoint.c ---- */

/* A part of a correction of the adjoint, which ticks may lie between: the first ADJOINT_PARTS correct it,
 * FORCE_PARTS and two more find rt->forgets. */
enum { ADJOINT_PARTS = 4, FORCE_PARTS = 8 };
void realtime_improve_adjoint(palp_realtime *rt, int part);

/* Sum of the shares of the arms' forces that a tick takes away. */
double realtime_leak(const palp_network *net);

/* What is known of its error where the nodes are at next.x; that error, in the norm of the tangent. */
void realtime_follow_adjoint(palp_realtime *rt);
double realtime_adjoint_error(const palp_realtime *rt);

/* What is found of an error with a factor that is a bad one, times this, is no less than the error or not
 * much. */
double realtime_doubt(const palp_realtime *rt);

/* The adjoint anew and what is known of it and of the factor, if that was just made of the last evaluation,
 * which was network_evaluate's at the committed state and is so again afterwards. */
void realtime_begin_adjoint(palp_realtime *rt, bool made);

/* ---- realtime_touch.c ---- */

/* Size of the resultant of the terms' forces, N. */
double realtime_outer_force(const palp_network *net);

/* rt->weight of the last evaluation. */
void realtime_weigh(palp_realtime *rt);

/* Stiffness that the tissue's own elements give the nodes that terms press on, summed over nodes and axes,
 * N/m. */
double realtime_own_stiffness(palp_realtime *rt);

/* Might the residual be less than this norm where the nodes are now? The elements' forces are taken from the
 * tick before: yes where that does not tell. Leaves all as it was but for the scratch rt->q and rt->move. */
bool realtime_may_stay(palp_realtime *rt, double norm);

/* ---- realtime_touched.c ---- */

/* As realtime_solve, where tools touch: in the directions of this tick's corrections so far and a new one
 * each. */
size_t realtime_solve_touched(palp_realtime *rt, size_t limit, double share);

/* ---- realtime_refresh.c ---- */

/* Is it a tool or a hand? What acts everywhere counts as tissue. */
bool realtime_touches(const network_term *term);

/* Has the network terms that add blocks to the tangent: tools, grasped nodes? */
bool realtime_touched(const palp_network *net);

/* Brings what terms add to the tangent up to date in the factor in use, as far as can be. */
void realtime_touch(palp_realtime *rt);

/* A factor at once, from the last evaluation, which was network_evaluate's; rt->element is made of it, too.
 */
palp_status realtime_refresh_now(palp_realtime *rt);

/* Does the next piece of it begin with the tangent of the last evaluation? */
bool realtime_refresh_begins(const palp_realtime *rt);

/* A piece of the next factor; true if it came into use. */
bool realtime_refresh(palp_realtime *rt);

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
