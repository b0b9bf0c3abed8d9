/* network_internal.h: the network's inside, shared by its own files and by calibration. */
#ifndef NETWORK_INTERNAL_H
#define NETWORK_INTERNAL_H

#include "material/element.h"
#include "solve/linsys.h"
#include "cut/network_cut.h"
#include "contact/network_load.h"
#include "realtime/network_realtime.h"

/* One state of the whole network. */
typedef struct network_state {
    double *x;              /* [3 n_nodes] positions, m */
    double *velocity;       /* [3 n_nodes], mass only */
    double *acceleration;   /* [3 n_nodes], mass only */
    double *inner;          /* [3 n_nodes] force of the elements on each node, N */
    double *element;        /* [n_elements] element force, tension positive, N */
    element_history history;
    double *vector;         /* [3 n_elements] force on the first node, PALP_SEDEF2008 only */
    void *load;             /* [load_size] bytes: friction, held nodes, where tools were; or NULL */
    double depth, time, force;
} network_state;

enum { NETWORK_PAST = 2 };

struct palp_network {
    palp_network_settings settings;
    palp_material material;
    palp_mesh *mesh;
    size_t n_nodes, n_elements, n_free;
    const double *rest;   /* mesh's */
    const int32_t *pair;  /* mesh's */
    double *inverse_rest; /* [n_elements] 1 / rest length */
    double *scale;        /* [n_elements] factor of each element's force, 0 = cut; or NULL = all 1 */
    network_load *load;   /* what acts on the nodes from outside, or NULL */
    size_t load_size;     /* bytes of each state's load */
    const int32_t *surface; /* [3 n_surface] triangles of the surface as it now is, outward */
    size_t n_surface;
    size_t surface_changes; /* counts what replaced the surface */
    network_cut *cut;     /* what is cut and torn, or NULL */
    network_realtime *realtime; /* for palp_network_step_within, or NULL */
    double *motion;       /* [3 n_nodes] displacement per depth, 0 unless driven */
    bool driven;          /* some axis is */
    int32_t *dof;         /* [3 n_nodes] unknown, or -1 */
    double *mass;         /* [n_nodes] kg, or NULL */
    double *grip;         /* [3 n_nodes] N/m, springs from a node to its place at rest, or NULL */
    const element_wear *wear; /* of every element's spring, or NULL; caller's */
    double boost;         /* factor of every spring's force in the next try */
    double extent;        /* largest rest dimension, m */
    double height;        /* rest dimension along the plate's motion, m */

    linsys *ls;
    uint32_t *slot;       /* [9 n_elements] value slots of block (b, a) by rows */
    uint32_t *slot_node;  /* [6 n_nodes] of the lower triangle of a node's own block */
    double *node_block;   /* [6 n_nodes] */
    bool chord;           /* factors are dear: keep one as long as it contracts */
    bool factored;        /* the factor belongs to this network state or one near it */

    /* of the last evaluation, at next */
    element_step step;
    double *direction;    /* [3 n_elements] unit vector first -> second node */
    double *inverse_length; /* [n_elements] */
    double *strain, *force, *tangent; /* [n_elements]; force without the carried vector */
    double *fint;         /* [3 n_nodes] */
    double inertia;       /* kg-independent factor of the mass term, 1/s^2 */
    double *inertia_rhs;  /* [3 n_nodes], mass only */
    double *rhs, *dx, *start; /* [n_free] residual, direction, unknowns it starts from */
    double *scratch;      /* [2 n_elements] */

    network_state now, next, mark;
    double *way[2];       /* [3 n_nodes] waypoints of a step that is approached in parts */
    double *past[NETWORK_PAST];
    double past_depth[NETWORK_PAST], past_time[NETWORK_PAST];
    size_t n_past;
    bool can_undo;        /* next and next.x still hold what the last commit replaced, */
    size_t undo_n_past;   /* these the rest */
    double undo_depth, undo_time;
    bool no_approach;     /* the caller makes its own smaller steps */
    bool exact;           /* the factor is that of the solved step at hand */
    bool left_branch;     /* STABLE: the step met an indefinite tangent */
    bool trial;           /* next holds a solved step */
    bool trial_stable;    /* its tangent is positive definite, as far as was looked */
    bool trial_checked;

    bool buckled;
    double checked_depth, unstable_depth; /* depth last seen stable; first seen not */
};

/* Geometry, element forces and nodal sums at next.x. False: a collapsed element or a non-finite force. */
bool network_evaluate(palp_network *net);

/* |residual|_2 of the unknowns into rhs (K dx = rhs), and the scale it is judged by. */
double network_residual(palp_network *net, double *scale);

/* Tangent of the last evaluation plus shift on the diagonal, into the solver's values. */
void network_assemble(palp_network *net, double shift);

/* The same, factored. */
palp_status network_factor(palp_network *net, double shift, int *negative);

/* d fint / d depth on the unknowns: column[n_free]. */
void network_drive_column(palp_network *net, double *column);

/* Energy of next.x, J (mass term included); false if the material has none. */
bool network_energy(palp_network *net, double *energy);

double network_drive_force(const palp_network *net);

/* Sets next.x of held and driven axes for a depth. */
void network_place(palp_network *net, double depth);

/* What opens a time step (arguments, constants of the step, inertia, load) and what closes a solved one: what next
 * holds beside positions and history. */
palp_status network_begin(palp_network *net, double depth_m, double dt_s);
void network_finish(palp_network *net);

/* Extrapolates next.x along the path (depth, or time in a hold) through the last two states, curved: three; and
 * evaluates. False if they do not lead there. */
bool network_extrapolate(palp_network *net, double depth, double time, bool curved);

/* out = tangent of the last evaluation times u, [3 n_nodes] both, held axes included. */
void network_tangent_times(const palp_network *net, const double *u, double *out);

/* The part of the tangent that is no element's: of each node on itself, block[6 n_nodes], lower triangle by rows, and
 * as network_load_blocks the couplings by the load, of which it returns the number. */
size_t network_node_blocks(const palp_network *net, double *block, size_t max, load_coupling *coupling);

/* From next.x to equilibrium, along the branch that the settings ask for (network_newton.c). */
palp_status network_newton(palp_network *net, palp_step_info *info);

/* After a converged try or step: factors at the solution and gives the elongation of each element per
 * unit depth, weight[n_elements], and dforce/ddepth, N/m. A parameter p of the element force changes the
 * reaction by sum weight dforce_e/dp (adjoint of the equilibrium). */
palp_status network_weights(palp_network *net, double *weight, double *stiffness);

/* Lets the springs wear and resets the network. *wear is the caller's and stays. */
palp_status network_set_wear(palp_network *net, const element_wear *wear);

/* Springs that resist what the free axes of a node set move: share times the stiffness at rest of the
 * elements that meet in the node. */
palp_status network_set_grip(palp_network *net, const char *set, double share);

/* Copies now to mark and back; the predictor forgets its past. */
void network_mark(palp_network *net);
void network_revert(palp_network *net);

void network_state_copy(const palp_network *net, network_state *to, const network_state *from);

/* Gives the network a load, which it then owns, and states with size bytes for it; resets the network. */
palp_status network_set_load(palp_network *net, network_load *load, size_t size);

#endif
