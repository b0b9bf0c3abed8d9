/* realtime_internal.h: inside of a palp_realtime, shared by its own files. */
#ifndef REALTIME_INTERNAL_H
#define REALTIME_INTERNAL_H

#include "base/arena.h"
#include "network/network_internal.h"
#include "solve/multigrid.h"

#include <palpate/realtime.h>

typedef struct refresh_thread refresh_thread;

/* Tetrahedra, and blocks of terms on all nodes, are visited in so many parts, one a tick. */
enum { REALTIME_PARTS = 16 };

/* Corrections of a tick whose directions are kept where tools touch. */
enum { REALTIME_DIRECTIONS = 12 };

typedef enum refresh_stage { REFRESH_DUE, REFRESH_MAKE } refresh_stage;

/* Seconds that parts of a tick take, running means. */
typedef struct realtime_times {
    double evaluation, correction, rest;
} realtime_times;

struct palp_realtime {
    arena memory;
    palp_network *net; /* owned by the caller */
    palp_realtime_settings settings;
    multigrid *mg;
    double *r, *z, *p, *q; /* [3 n_nodes] conjugate gradients, 0 at fixed axes */
    double *move;          /* [3 n_nodes] correction */
    double *direction, *inner,
        *tangent; /* [3 n_nodes * REALTIME_DIRECTIONS], or NULL without tools. Directions of this tick's
                     corrections, of length 1 in the norm of the factor; their products with the tissue's and
                     with the whole tangent */
    double curvature[REALTIME_DIRECTIONS][REALTIME_DIRECTIONS]; /* [j][i]: direction i times tangent j */
    size_t n_directions;
    double *adjoint;     /* [3 n_nodes] dx / d depth, the motion at fixed axes */
    double *weight;      /* [n_nodes] stiffness of what presses on a node, N/m */
    uint32_t *run_place; /* [runs] position of each run of elements, see realtime_place_runs, or NULL */
    float *element; /* [n_floats] blocks of elements at the last evaluation with the tangent, in the layout of
                       rt->mg */
    bool fresh;     /* the last evaluation made rt->element */
    bool kept;      /* the last evaluation kept strain, force and history */
    bool indefinite;               /* the tangent was not positive definite in this tick */
    bool idle, near;               /* the last tick made no correction; it came near to one */
    double *adjoint_r, *adjoint_z; /* [3 n_nodes] of the correction of the adjoint in progress */
    double *tissue;      /* [3 n_nodes] forces of the elements in the committed state, N, where tools touch */
    float *adjoint_half; /* [multigrid_half_size] between the two halves of its cycle */
    bool driven;         /* some axis is driven, so there is an adjoint */
    double spread;       /* of terms that act on all nodes, 0 = there are none */
    double *adjoint_at[2];   /* [3 n_nodes] positions at which the error was found: of the adjoint in use, and
                                of the correction in progress */
    double adjoint_error;    /* its error there, in the energy norm */
    double adjoint_rate;     /* growth of that error with the distance from there, 1/m */
    double adjoint_far;      /* distance of the nodes from there, m, as one vector */
    double adjoint_farthest; /* the largest adjoint_far so far */
    double adjoint_found;    /* adjoint_far when the correction in progress began */
    double forgets; /* error of the force due to the arms' relaxation in a tick; relative to the share of the
                       stiffness that relaxes and to the positions' error in the energy norm */
    double doubt;   /* largest ratio of an error in the energy norm to the factor's estimate of it; 1 if both
                       agree */
    double error_ratio; /* that error over |residual|, when last estimated */
    double arm_error[PALP_REGIONS_MAX + 1][PALP_ARMS_MAX]; /* error of the force in the history of each arm of
                                                              each material, N */
    double remembered;               /* their sum, of the material where it is largest */
    double anchored;                 /* error of the force in the reference points of friction, N */
    double guessed;                  /* residual of the last tick's first guess, N */
    double contraction;              /* final over first residual of the last tick */
    size_t part;                     /* part of the tetrahedra that the next tick visits */
    size_t inverted[REALTIME_PARTS]; /* count of each part */
    size_t resets;                   /* the network's count of resets when the factor was made */

    multigrid_coupling *touching; /* [MULTIGRID_COUPLINGS] scratch */
    refresh_stage stage;          /* of the next factor */
    size_t at;                    /* ticks since it was due, or pieces made */
    size_t gathered;              /* parts of the blocks on all nodes gathered for it */
    double piece;                 /* work on it in one tick */
    bool definite;                /* it leaves out what can make it indefinite */
    bool used_definite;           /* the same of the factor in use */
    int adjoint_due,
        adjoint_parts;      /* parts left of a correction of the adjoint; all of them (fewer without arms) */
    refresh_thread *thread; /* makes the next factor, or NULL */

    realtime_times times;
};

/* ---- realtime_solve.c ---- */

/* Finds the position of each run of elements in rt->element, if each run is contiguous there. */
palp_status realtime_place_runs(palp_realtime *rt);

/* As network_evaluate; with the tangent, the elements' blocks go into rt->element. trial: a correction
 * follows, so strain, force and history need not be kept. */
bool realtime_evaluate(palp_realtime *rt, bool tangent, bool trial);

/* q = tangent of the last evaluation times p on the free axes, 0 on the others. Only the symmetric part, in
 * single precision: residuals are evaluated anew before they are judged. */
void realtime_tangent_times(palp_realtime *rt, const double *p, double *q);

/* The same without tools and hands; and the part of tools and hands, added to q, with its unsymmetric
 * part. */
void realtime_tissue_times(palp_realtime *rt, const double *p, double *q);
void realtime_add_touching(const palp_realtime *rt, bool whole, const double *p, double *q);

/* rt->move: a short step downhill along rt->z. */
void realtime_move_a_little(palp_realtime *rt);

/* Preconditioned conjugate gradients on the tangent of the last evaluation, from rt->r, in at most limit
 * corrections. They stop at share of the first residual, or when the positions' error in the energy norm is
 * below enough. The correction is in rt->move; returns the number of iterations. */
size_t realtime_solve(palp_realtime *rt, size_t limit, double share, double enough);

/* ---- realtime_adjoint.c ---- */

/* Parts of a correction of the adjoint, one a tick: ADJOINT_PARTS correct it, FORCE_PARTS and two more find
 * rt->forgets. */
enum { ADJOINT_PARTS = 4, FORCE_PARTS = 8 };
void realtime_improve_adjoint(palp_realtime *rt, int part);

/* Updates adjoint_far for next.x. Error of the adjoint there, in the energy norm. */
void realtime_follow_adjoint(palp_realtime *rt);
double realtime_adjoint_error(const palp_realtime *rt);

/* Factor by which an error estimated with the factor in use is multiplied to be a bound, or nearly one. */
double realtime_doubt(const palp_realtime *rt);

/* Makes the adjoint anew. If made, the factor is new and of the last evaluation, network_evaluate's at the
 * committed state; then the error estimates are made too, and the evaluation is restored. */
void realtime_begin_adjoint(palp_realtime *rt, bool made);

/* ---- realtime_touch.c ---- */

/* Size of the resultant of the terms' forces, N. */
double realtime_outer_force(const palp_network *net);

/* Sets rt->weight from the last evaluation. */
void realtime_weigh(palp_realtime *rt);

/* Stiffness of the tissue's elements at nodes that terms press on, summed over nodes and axes, N/m. */
double realtime_own_stiffness(palp_realtime *rt);

/* Could the residual at the committed positions be below this norm? The elements' forces are the last tick's;
 * true where these are unknown. Changes only the scratch arrays rt->q and rt->move. */
bool realtime_may_stay(palp_realtime *rt, double norm);

/* ---- realtime_touched.c ---- */

/* As realtime_solve, where tools touch: in the directions of this tick's corrections so far and a new one
 * each. */
size_t realtime_solve_touched(palp_realtime *rt, size_t limit, double share);

/* ---- realtime_refresh.c ---- */

/* Is it a tool or a hand? Terms on all nodes count as tissue. */
bool realtime_touches(const network_term *term);

/* Does the network have tools or grasped nodes, which add blocks to the tangent? */
bool realtime_touched(const palp_network *net);

/* Updates what terms add to the tangent in the factor in use, as far as possible. */
void realtime_touch(palp_realtime *rt);

/* Makes a factor at once from the last evaluation, network_evaluate's; fills rt->element too. */
palp_status realtime_refresh_now(palp_realtime *rt);

/* Does the next piece of the factor begin with the tangent of the last evaluation? */
bool realtime_refresh_begins(const palp_realtime *rt);

/* Makes a piece of the next factor; true if it came into use. */
bool realtime_refresh(palp_realtime *rt);

/* ---- realtime_thread.c ---- */

palp_status refresh_thread_create(multigrid *mg, refresh_thread **out);
void refresh_thread_free(refresh_thread *t); /* NULL is fine; waits for the thread */

/* Starts the work that multigrid_begin prepared. */
void refresh_thread_start(refresh_thread *t);

/* Is the work done? *status is its result. Does not wait. */
bool refresh_thread_done(refresh_thread *t, palp_status *status);
void refresh_thread_wait(refresh_thread *t);

double realtime_clock(void); /* s, monotonic */

#endif
