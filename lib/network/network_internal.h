/* network_internal.h: the network's inside, shared by its own files and by the layers that sit on it. */
#ifndef NETWORK_INTERNAL_H
#define NETWORK_INTERNAL_H

#include "base/arena.h"
#include "material/element.h"
#include "network_term.h"
#include "solve/linsys.h"

/* One state of nodes and elements; terms keep their own. */
typedef struct network_state {
    double *x;            /* [3 n_nodes] positions, m */
    double *velocity;     /* [3 n_nodes], mass only */
    double *acceleration; /* [3 n_nodes], mass only */
    double *inner;        /* [3 n_nodes] force of elements and outer terms on each node, N */
    double *element;      /* [n_elements] element force, tension positive, N */
    element_history history;
    double *vector; /* [3 n_elements] force on the first node, PALP_SEDEF2008 only */
    double depth, time, force;
} network_state;

enum { NETWORK_PAST = 2, NETWORK_TERMS = 8 };

/* The loops over elements go by chunks of so many. */
enum { NETWORK_CHUNK = 256 };

/* Elements in a row, of which the k-th joins nodes low + k and high + k. */
typedef struct network_run {
    int32_t low, high, n;
} network_run;

struct palp_network {
    arena memory, states; /* of its arrays; of those of now, next and past */
    palp_network_settings settings;
    palp_material material;
    palp_mesh *mesh;
    size_t n_nodes, n_elements, n_free;
    const double *rest;   /* mesh's */
    const int32_t *pair;  /* mesh's */
    double *inverse_rest; /* [n_elements] 1 / rest length */
    network_run *run;  /* all elements in order, none over the end of a chunk; or NULL: they are too short to
                          be worth it */
    size_t *first_run; /* [n_chunks + 1] of each chunk of elements, the number of runs last */
    double *straight;  /* [6 network_stride] with runs: a vector by axis, and a sum */
    double *scale;     /* [n_elements] factor of each element's force, 0 = cut; or NULL = all 1 */
    const int32_t *dead; /* [n_dead] elements that are cut; a term's */
    size_t n_dead;
    const int32_t *surface; /* [3 n_surface] triangles of the surface as it now is, outward */
    size_t n_surface;
    size_t surface_changes; /* counts what replaced the surface */
    bool surface_stays;     /* a term has made its own of it: nothing may replace it */
    double *motion;         /* [3 n_nodes] displacement per depth, 0 unless driven */
    bool driven;            /* some axis is */
    int32_t *dof;           /* [3 n_nodes] unknown, or -1 */
    double *mass;           /* [n_nodes] kg, or NULL */
    double *unit; /* [n_nodes] a node's own stiffness over that of an element, mean of directions, 1/m */
    const element_damage *damage; /* of every element's spring, or NULL; caller's */
    double rate_factor;           /* of every spring's force in the next try */
    double extent;                /* largest rest dimension, m */
    double height;                /* rest dimension along the plate's motion, m */
    size_t resets;                /* counts the returns to rest */

    network_term *terms[NETWORK_TERMS];
    size_t n_terms;

    linsys *ls;
    uint32_t *slot;       /* [9 n_elements] value slots of block (b, a) by rows */
    uint32_t *slot_node;  /* [6 n_nodes] of the lower triangle of a node's own block */
    double *node_block;   /* [6 n_nodes] */
    int32_t *other_pair;  /* [2 n_other_pairs] nodes, low and high, that no element joins and a term may;
                             sorted; or NULL */
    uint32_t *other_slot; /* [9 n_other_pairs] as slot */
    size_t n_other_pairs;
    bool reuse_factor; /* factors are dear: keep one as long as it contracts */
    bool factored;     /* the factor belongs to this network state or one near it */

    /* of the last evaluation, at next */
    element_step step;
    double modulus;         /* instantaneous stiffness of an element at rest, N */
    double *direction;      /* [3 n_elements] unit vector first -> second node: all x, all y, all z */
    double *inverse_length; /* [n_elements] */
    double *strain,
        *force;           /* [n_elements] of the state that was next then; force without the carried vector */
    double *own_force;    /* [n_elements] force where a vector is carried, or NULL */
    double *tangent;      /* [n_elements] */
    double *fint;         /* [3 n_nodes] force of the elements */
    double *outer;        /* [3 n_nodes] force of terms, on supported nodes too */
    double outer_squares; /* as the squares of a term's residual */
    double force_squares, tangent_squares; /* sums over the elements, N^2 */
    double *diagonal;                      /* [3 n_nodes] of the tangent, by terms, N/m */
    double *unbalanced;                    /* [3 n_nodes] all forces, scratch */
    double *rhs, *dx, *start;              /* [n_free] residual, direction, unknowns it starts from */
    double *scratch;                       /* [2 n_elements] */

    network_state now, next;
    unsigned char *mark; /* a state saved, see network_mark_save */
    double *way[2];      /* [3 n_nodes] waypoints of a step that is approached in parts */
    double *past[NETWORK_PAST];
    double past_depth[NETWORK_PAST], past_time[NETWORK_PAST];
    size_t n_past;
    bool no_approach;  /* the caller makes its own smaller steps */
    bool stepped;      /* there is a palp_realtime of it */
    bool exact;        /* the factor is that of the solved step at hand */
    bool left_branch;  /* STABLE: the step met an indefinite tangent */
    bool trial;        /* next holds a solved step */
    bool trial_stable; /* its tangent is positive definite, as far as was assessed */
    bool trial_checked;

    bool buckled;
    double checked_depth, unstable_depth; /* depth last seen stable; first seen not */
};

/* ---- network_pattern.c ---- */

/* The solver for the tangent's pattern, and where each block of it goes. */
palp_status network_make_pattern(palp_network *net);

/* Room in it for blocks between more pairs of nodes, low <= high, sorted by low, then high; those that have
 * it already are passed over. Once for each network. */
palp_status network_add_pairs(palp_network *net, size_t n, const int32_t *low, const int32_t *high);

/* Value slots of such a pair's block (high, low) by rows, or NULL. */
const uint32_t *network_other_slots(const palp_network *net, int32_t low, int32_t high);

/* ---- network_state.c ---- */

/* The states, as large as material, damage and terms ask for. On failure the old ones stay. */
palp_status network_allocate_states(palp_network *net);

/* strain and force are those of the next state. */
void network_point_at_next(palp_network *net);

/* The committed state aside and back; the predictor then forgets its past. */
void network_mark_save(palp_network *net);
void network_mark_restore(palp_network *net);

/* Continues a checksum, which starts as NETWORK_SUM, over more bytes. */
#define NETWORK_SUM UINT64_C(0xcbf29ce484222325)
uint64_t network_sum(uint64_t sum, const void *data, size_t bytes);

/* ---- network_elements.c ---- */

/* The runs, where they are long enough. */
palp_status network_make_runs(palp_network *net);

/* The elements' part of the tangent in single precision: the block of element i is along d d' + across 1, d
 * from node to node. */
typedef struct network_blocks {
    float *element;        /* along, across; of element i from place[i] on, spacing apart */
    const uint32_t *place; /* [n_elements] */
    size_t spacing;
    const uint32_t *run_place; /* [runs] place of each run's first element, where those of all runs follow
                                  each other; or NULL */
    bool trial;                /* strain, force and history need not be kept */
} network_blocks;

/* Geometry and forces of the elements at next.x and their sums on nodes. False: one has collapsed. With
 * blocks these are made unless blocks->element is NULL, and neither direction, inverse_length nor tangent
 * need be, which takes less memory and time. */
bool network_element_forces(palp_network *net, const network_blocks *blocks);

/* out = tangent of the last evaluation (of one without blocks) times u, [3 n_nodes] both, fixed axes
 * included. */
void network_tangent_times(const palp_network *net, const double *u, double *out);

/* Sum of a[i] b[i]. */
double network_dot(const double *a, const double *b, size_t n);

/* Root of the sum of (a[i] - b[i])^2. */
double network_distance(const double *a, const double *b, size_t n);

/* ---- network_assemble.c ---- */

/* Geometry, element forces, nodal sums and terms at next.x. False: a collapsed element or a non-finite force.
 */
bool network_evaluate(palp_network *net);
bool network_evaluate_blocks(palp_network *net,
                             const network_blocks *blocks); /* as network_element_forces with blocks */
void network_evaluate_terms(palp_network *net);             /* the terms alone */

/* Sum of the elements' rest lengths, each times its element's factor, m. The energy of an even strain is
 * proportional to this sum and to the law: networks of one body are the same material when their laws are
 * inversely proportional to it. Young's modulus is K times this over six volumes. */
double network_shared_length(const palp_network *net);

/* |residual|_2 of the unknowns into rhs (K dx = rhs), and the scale it is judged by. */
double network_residual(palp_network *net, double *scale);

/* net->diagonal of the terms as they stand, plus shift. */
void network_set_diagonal(palp_network *net, double shift);

/* Tangent of the last evaluation plus shift on the diagonal, into the solver's values. */
void network_assemble(palp_network *net, double shift);

/* The same, factored. */
palp_status network_factor(palp_network *net, double shift, int *negative);

/* d fint / d depth on the unknowns: column[n_free]. */
void network_drive_column(palp_network *net, double *column);

/* Energy of next.x, J (mass term included); false if the material or a term has none. */
bool network_energy(palp_network *net, double *energy);

double network_drive_force(const palp_network *net);

/* After a converged try or step: factors at the solution and gives the elongation of each element per
 * unit depth, weight[n_elements], and dforce/ddepth, N/m. A parameter p of the element force changes the
 * reaction by sum weight dforce_e/dp (adjoint of the equilibrium). */
palp_status network_weights(palp_network *net, double *weight, double *stiffness);

/* ---- network_newton.c ---- */

/* From next.x to equilibrium, along the branch that the settings ask for. */
palp_status network_newton(palp_network *net, palp_step_info *info);

/* ---- network_step.c ---- */

/* Sets next.x of fixed and driven axes for a depth. */
void network_place(palp_network *net, double depth);

/* What opens a time step (arguments, constants of the step, terms) and what closes a solved one: what next
 * holds beside positions and history. ERR_INSIDE: a tool has lost the surface. */
palp_status network_begin(palp_network *net, double depth_m, double dt_s);
palp_status network_finish(palp_network *net);

/* How far terms go in this step, over the farthest that one is followed at once; 0 = they stay. */
double network_longest_way(const palp_network *net);

/* Largest |strain[n_elements]| of the elements that are not cut. */
double network_largest_strain(const palp_network *net, const double *strain);

/* The tetrahedra that are inside out or flat with the nodes at x; of part of parts of them, 0 of 1 = all. */
size_t network_count_inverted(const palp_network *net, const double *x, size_t part, size_t parts);

/* Has a term had its points taken anew (network_term refresh)? It is then to be evaluated and solved again.
 */
bool network_refresh(palp_network *net);

/* Extrapolates next.x along the path (depth, or time in a dwell) through the last two states, curved: three;
 * and evaluates. False if they do not lead there. */
bool network_extrapolate(palp_network *net, double depth, double time, bool curved);

/* ---- network.c ---- */

/* Lets the springs damage and resets the network. *damage is the caller's and stays. */
palp_status network_set_damage(palp_network *net, const element_damage *damage);

/* ---- terms of the network's own ---- */

/* The mass terms of time integration; NULL: out of memory. */
network_term *network_inertia_new(const palp_network *net);

/* Weight of the network's mass, m/s^2; NULL: out of memory. */
network_term *network_gravity_new(const double acceleration_m_s2[3]);

/* Springs that resist what the free axes of a node set move: share times the stiffness at rest of the
 * elements that meet in the node. They add up over calls. */
palp_status network_set_foundation(palp_network *net, const char *set, double share);

/* Their stiffness [3 n_nodes], N/m, or NULL. */
const double *network_foundation(const palp_network *net);

/* Tetrahedra that resist a change of their volume (network_volume.c), of this modulus. ERR_UNSUPPORTED: the
 * mesh has none, one that is flat, or one whose edges are not all elements. */
palp_status network_add_volume(palp_network *net, double modulus_Pa);
bool network_has_volume(const palp_network *net);

#endif
