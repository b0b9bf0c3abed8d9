/* network_internal.h: internal data of a network, for its own files and the layers that use it. */
#ifndef NETWORK_INTERNAL_H
#define NETWORK_INTERNAL_H

#include "base/arena.h"
#include "material/element.h"
#include "network_ranks.h"
#include "network_term.h"
#include "solve/linsys.h"

/* One state of nodes and elements; terms have states of their own. */
typedef struct network_state {
    double *x;            /* [3 n_nodes] positions, m */
    double *velocity;     /* [3 n_nodes], mass only */
    double *acceleration; /* [3 n_nodes], mass only */
    double *inner;        /* [3 n_nodes] force of elements and outer terms on each node, N */
    double *element;      /* [n_elements] element force, tension positive, N */
    element_history history;
    element_history region[PALP_REGIONS_MAX]; /* of regions with a material of their own */
    double *vector; /* [3 n_elements] force on the first node, PALP_SEDEF2008 only */
    double depth, time, force;
} network_state;

enum { NETWORK_PAST = 2, NETWORK_TERMS = 10 };

/* Loops over elements go in chunks of so many. */
enum { NETWORK_CHUNK = 256 };

/* Consecutive elements, of which the k-th joins nodes low + k and high + k. */
typedef struct network_run {
    int32_t low, high, n;
} network_run;

/* A region, and how much of each solid and element is in it. */
typedef struct network_region {
    palp_region given;
    double *inside; /* [mesh_solids] part of each, without what later regions have of it */
    double *share;  /* [n_elements] of the element's force, or NULL: no material of its own */
    element_step step;
    double modulus; /* as the network's, of its own material */
} network_region;

/* One of the materials of a network's elements: 0 is that of the network, r + 1 that of region r. */
typedef struct network_material {
    const palp_material *material;
    const element_step *step;
    const element_history *now;
    const double *share; /* [n_elements] in each element's force, or NULL = all */
    double modulus;      /* instantaneous stiffness at rest, N */
} network_material;

/* Blocks of the tangent that are not in the factor, see network_solve.c. */
typedef struct network_far {
    size_t n, room;
    int32_t *node;                                 /* [2 n] row and column of each, which are different */
    double *block;                                 /* [9 n] by rows */
    double *residual, *direction, *near, *product; /* [n_free] of conjugate gradients */
} network_far;

struct palp_network {
    arena memory, states; /* of its arrays; of the states now, next and past */
    palp_network_settings settings;
    palp_material material;
    palp_mesh *mesh;
    size_t n_nodes, n_elements, n_free;
    const double *rest;   /* the mesh's */
    const int32_t *pair;  /* the mesh's */
    double *inverse_rest; /* [n_elements] 1 / rest length */
    network_run
        *run; /* all elements in order, none across the end of a chunk; NULL if runs are too short to pay */
    size_t *first_run; /* [n_chunks + 1] first run of each chunk, then the number of runs */
    double *straight;  /* [6 network_stride] with runs: a vector by axis, and a sum */
    double *scale;     /* [n_elements] factor of each element's force, 0 = cut; or NULL = all 1. Elements of
                          a region that only is stiffer have its stiffness here */
    size_t n_regions;
    network_region *region;
    double *base_share; /* [n_elements] share of the network's own material in each element's force; or NULL:
                           there are no others */
    unsigned short *chunk_has;   /* with base_share: materials of each chunk of elements, bit 0 for the
                                    network's   own, bit r + 1 for region r's */
    signed char *region_of_node; /* [n_nodes] the region that has most of the solids around a node, or -1;
                                    NULL without regions */
    double *edge;                /* [mesh_solids] network_edge_factors, or NULL = all 1 */
    double *stiffer;             /* [n_nodes] a node's stiffness over what it is without regions, or NULL */
    const int32_t *dead;         /* [n_dead] elements that are cut; belongs to a term */
    size_t n_dead;
    const int32_t *surface; /* [3 n_surface] present triangles of the surface, outward */
    size_t n_surface;
    size_t surface_changes; /* number of replacements of the surface */
    bool surface_stays;     /* a term depends on this surface: it must not be replaced */
    double *motion;         /* [3 n_nodes] displacement per depth, 0 unless driven */
    bool driven;            /* some axis is driven */
    int32_t *dof;           /* [3 n_nodes] unknown, or -1 */
    double *mass;           /* [n_nodes] kg, or NULL */
    double *unit; /* [n_nodes] a node's stiffness over that of an element, mean of directions, 1/m */
    const element_damage *damage; /* of every element's spring, or NULL; owned by the caller */
    double rate_factor;           /* factor of every spring's force in the next try */
    double extent;                /* largest rest dimension, m */
    double height;                /* rest dimension along the plate's motion, m */
    size_t resets;                /* number of returns to rest */

    network_term *terms[NETWORK_TERMS];
    size_t n_terms;

    network_ranks *ranks; /* of a part of a larger network, or NULL; then there are no ls and slots */
    linsys *ls;
    uint32_t *slot;       /* [9 n_elements] value slots of block (b, a) by rows */
    uint32_t *slot_node;  /* [6 n_nodes] of the lower triangle of a node's own block */
    double *node_block;   /* [6 n_nodes] */
    int32_t *other_pair;  /* [2 n_other_pairs] low and high node of pairs without an element that a term may
                             join; sorted; or NULL */
    uint32_t *other_slot; /* [9 n_other_pairs] value slots as in slot */
    size_t n_other_pairs;
    network_far far;
    bool reuse_factor; /* factorization is expensive: keep a factor as long as it contracts */
    bool factored;     /* the factor is of this network's state or of one near it */

    /* of the last evaluation, at next */
    element_step step;
    double modulus;         /* instantaneous stiffness of an element at rest, N */
    double *direction;      /* [3 n_elements] unit vector first -> second node: all x, all y, all z */
    double *inverse_length; /* [n_elements] */
    double *strain,
        *force;        /* [n_elements] at the last evaluation; force without the vector from the last step */
    double *own_force; /* [n_elements] force where there is such a vector, or NULL */
    double *tangent;   /* [n_elements] */
    double *fint;      /* [3 n_nodes] force of the elements */
    double *outer;     /* [3 n_nodes] force of terms, at supported nodes too */
    double outer_squares; /* squares of stiffness times position of these terms, see residual in
                             network_term.h */
    double force_squares, tangent_squares; /* sums over the elements, N^2 */
    double *diagonal;                      /* [3 n_nodes] diagonal of the terms' tangent, N/m */
    double *unbalanced;                    /* [3 n_nodes] sum of all forces, scratch */
    double *rhs, *dx, *start; /* [n_free] residual, direction, unknowns at the start of a line search */
    double *scratch;          /* [2 n_elements] */

    network_state now, next;
    unsigned char *mark; /* a saved state, see network_mark_save */
    double *way[2];      /* [3 n_nodes] intermediate positions of a step that is made in parts */
    double *past[NETWORK_PAST];
    double past_depth[NETWORK_PAST], past_time[NETWORK_PAST];
    size_t n_past;
    bool no_approach;  /* the caller makes smaller steps itself */
    bool stepped;      /* a palp_realtime steps it */
    bool exact;        /* the factor is that of the present solution */
    bool left_branch;  /* PALP_BRANCH_STABLE: the step met an indefinite tangent */
    bool trial;        /* next holds a solved step */
    bool trial_stable; /* its tangent is positive definite, as far as assessed */
    bool trial_checked;

    bool buckled;
    double checked_depth, unstable_depth; /* last depth known to be stable; first known to be unstable */
};

/* ---- network_pattern.c ---- */

/* Makes the solver for the tangent's pattern and finds where each block of it goes. */
palp_status network_make_pattern(palp_network *net);

/* Adds room for blocks between more pairs of nodes, low <= high, sorted by low, then high. Pairs that have
 * room are skipped. Once for each network. */
palp_status network_add_pairs(palp_network *net, size_t n, const int32_t *low, const int32_t *high);

/* Value slots of the block (high, low) of such a pair, by rows, or NULL. */
const uint32_t *network_other_slots(const palp_network *net, int32_t low, int32_t high);

/* ---- network_solve.c ---- */

/* Makes more room for blocks that are not in the factor. */
palp_status network_make_far_room(palp_network *net, size_t more);

/* Keeps such a block of the tangent that is being assembled, if there is room: a network_block_taker. */
void network_keep_far_block(void *net, int32_t row, int32_t column, const double k[9]);

/* x = K^-1 x with the tangent K of the last factor, [n_free]. */
void network_solve(palp_network *net, double *x);

/* ---- network_state.c ---- */

/* Allocates the states, sized for material, damage and terms. On failure the old ones stay. */
palp_status network_allocate_states(palp_network *net);

/* Makes strain and force those of the next state. */
void network_point_at_next(palp_network *net);

/* Saves the committed state and restores it; after that the predictor has no past. */
void network_mark_save(palp_network *net);
void network_mark_restore(palp_network *net);

/* Continues a checksum, which starts with NETWORK_SUM, over more bytes. */
#define NETWORK_SUM UINT64_C(0xcbf29ce484222325)
uint64_t network_sum(uint64_t sum, const void *data, size_t bytes);
uint64_t network_sum_of_material(uint64_t sum, const palp_material *m);

/* ---- network_regions.c ---- */

/* Copies the regions of the settings and finds their solids. ERR_ARGUMENT, ERR_INPUT, ERR_UNSUPPORTED, with a
 * line in error. */
palp_status network_take_regions(palp_network *net, palp_error *error);

/* Do the regions allow this as the network's own material? */
bool network_may_have_material(const palp_network *net, const palp_material *material);

/* Sets edge of a network that wants it. Errors as network_edge_factors. */
palp_status network_find_edges(palp_network *net, size_t n_supports, const palp_support *supports);

/* Sets scale, where there is one, and the shares of materials. */
palp_status network_scale_elements(palp_network *net);

/* For the parts of a network whose regions have no material of their own: each element's force over that
 * without regions and edges, element[n_elements], and network_volume_share times each solid's stiffness over
 * that without them, solid[mesh_solids]. Errors as network_take_regions, and ERR_INPUT: no such node set. */
palp_status network_scales_of_regions(const palp_mesh *mesh, const palp_material *material,
                                      const palp_network_settings *settings, size_t n_supports,
                                      const palp_support *supports, double *element, double *solid,
                                      palp_error *error);

/* Gives a region that only is stiffer another place, part[n_tetrahedra], and stiffness; resets the network.
 * Compliance of contacts that was derived before stays. */
palp_status network_change_region(palp_network *net, size_t of, const double *part, double stiffness);

/* Sets unit and stiffer for the present material. */
void network_find_units(palp_network *net);

/* The material of this number, from 0 to n_regions; false for a region without one of its own. */
bool network_material_at(const palp_network *net, size_t number, network_material *material);

/* K at a strain of the network's own material and of those of the regions, which follow, N; with arms their
 * springs count too. 0 for a region without a material of its own. */
void network_stiffnesses(const palp_network *net, double strain, bool with_arms,
                         double stiffness[PALP_REGIONS_MAX + 1]);

/* Mean over the materials of an element, weighed by their shares in its force. */
double network_mean_of_materials(const palp_network *net, size_t element,
                                 const double value[PALP_REGIONS_MAX + 1]);

/* Has a material a dashpot beside its spring? */
bool network_has_dashpot(const palp_network *net);

/* The mean over each of n solids of a quantity that is proportional to stiffness. value[r] is that of region
 * r, value[n_regions] that of all else. per_solid of the n are one of mesh_solids. */
void network_mean_of_solids(const palp_network *net, const double value[PALP_REGIONS_MAX + 1], size_t n,
                            size_t per_solid, double *mean);

/* How far the elements' strains exceed the measured range of their materials; 0 = not, or not known. */
double network_beyond(const palp_network *net, const double *strain);

/* ---- network_edges.c ----------------------------------------------------------------------------- */

/* Does this network want such factors: cells, scaled as a continuum, with the setting edge_correction? */
bool network_has_edges(const palp_mesh *mesh, const palp_network_settings *settings);

/* Factor of each cell's stiffness, of_solid[mesh_solids]. Cells at an edge between a bonded face and a free
 * one stand for the solid with it; elsewhere it is 1. A face is bonded where supports hold all axes of its
 * nodes. ERR_INPUT: no such node set; ERR_NO_MEMORY. */
palp_status network_edge_factors(const palp_mesh *mesh, const palp_network_settings *settings,
                                 size_t n_supports, const palp_support *supports, double *of_solid);

/* ---- network_elements.c ---- */

/* Finds the runs of elements, if they are long enough. */
palp_status network_make_runs(palp_network *net);

/* The elements' part of the tangent in single precision: the block of element i is along d d' + across 1,
 * with d the vector between its nodes. */
typedef struct network_blocks {
    float *element;        /* along, across; those of element i from place[i] on, spacing apart */
    const uint32_t *place; /* [n_elements] */
    size_t spacing;
    const uint32_t
        *run_place; /* [runs] place of each run's first element, where all runs are contiguous; or NULL */
    bool trial;     /* strain, force and history need not be kept */
} network_blocks;

/* Geometry and forces of the elements at next.x, and their sums on nodes. False: an element has collapsed.
 * With blocks, these are made unless blocks->element is NULL; direction, inverse_length and tangent are then
 * not kept, which saves memory and time. */
bool network_element_forces(palp_network *net, const network_blocks *blocks);

/* sum of a[i] b[i] */
double network_dot(const double *a, const double *b, size_t n);

/* Root of the sum of (a[i] - b[i])^2. */
double network_distance(const double *a, const double *b, size_t n);

/* k = (tangent / L0) n n' + (force / L) (1 - n n') of element i, lower triangle xx yx yy zx zy zz. */
void network_element_block(const palp_network *net, size_t i, double k[6]);

/* ---- network_parts.c ---- */

/* Over all parts of the network. */
double network_sum_of_parts(const palp_network *net, double value);
double network_largest_of_parts(const palp_network *net, double value);

/* Does a node count in this part? */
static inline bool network_owns(const palp_network *net, size_t node) {
    return !net->ranks || net->ranks->own[node];
}

/* ---- network_assemble.c ---- */

/* Geometry, element forces, nodal sums and terms at next.x. False: an element has collapsed or a force is not
 * finite. */
bool network_evaluate(palp_network *net);
bool network_evaluate_blocks(palp_network *net,
                             const network_blocks *blocks); /* as network_element_forces with blocks */
void network_evaluate_terms(palp_network *net);             /* only the terms */

/* Sum of the elements' rest lengths, each times the mesh's factor for it, m. The energy of an even strain is
 * proportional to this sum and to the law: networks of one body are the same material when their laws are
 * inversely proportional to it. Young's modulus is K times this over six volumes. */
double network_shared_length(const palp_network *net);

/* |residual|_2 of the unknowns into rhs (K dx = rhs), and the scale it is judged by. */
double network_residual(palp_network *net, double *scale);

/* Sets net->diagonal to the terms' diagonal plus shift. */
void network_set_diagonal(palp_network *net, double shift);

/* Writes the tangent of the last evaluation, plus shift on the diagonal, into the solver's values. */
void network_assemble(palp_network *net, double shift);

/* network_assemble, then factors. */
palp_status network_factor(palp_network *net, double shift, int *negative);

/* d fint / d depth for the unknowns: column[n_free]. */
void network_drive_column(palp_network *net, double *column);

/* Energy at next.x, J, with the mass term; false if the material or a term has none. */
bool network_energy(palp_network *net, double *energy);

double network_drive_force(const palp_network *net);

/* After a converged try or step: factors at the solution. weight[n_elements]: elongation of each element per
 * unit depth, times the share of the network's own material; *stiffness: dforce/ddepth, N/m. A parameter p of
 * that material's force changes the reaction by sum weight dforce_e/dp (adjoint of the equilibrium). */
palp_status network_weights(palp_network *net, double *weight, double *stiffness);

/* ---- network_solid.c ---- */

/* Do solids resist a change of volume? */
bool network_wants_volume(const palp_network_settings *settings);

/* Volume modulus of a solid with this Poisson's ratio (0 = that of the settings), over the settings' volume
 * modulus; if these have none, over Young's modulus of the springs. */
double network_volume_share(const palp_network_settings *settings, double ratio);

/* ---- network_newton.c ---- */

/* Solves for equilibrium from next.x, along the branch that the settings ask for. */
palp_status network_newton(palp_network *net, palp_step_info *info);

/* ---- network_step.c ---- */

/* Sets next.x of fixed and driven axes for a depth. */
void network_place(palp_network *net, double depth);

/* Start of a time step (arguments, constants of the step, terms), and end of a solved one: the parts of next
 * other than positions and history. ERR_INSIDE: a tool has lost the surface. */
palp_status network_begin(palp_network *net, double depth_m, double dt_s);
palp_status network_finish(palp_network *net);

/* Largest distance that a term moves in this step, over what it can be followed in one part; 0 = none
 * moves. */
double network_longest_way(const palp_network *net);

/* Largest |strain[n_elements]| of elements that are not cut. */
double network_largest_strain(const palp_network *net, const double *strain);

/* Number of inverted or flat tetrahedra with the nodes at x, in part of parts; 0 of 1 = all. */
size_t network_count_inverted(const palp_network *net, const double *x, size_t part, size_t parts);

/* Has a term found new contact points (network_term refresh)? Then evaluate and solve again. */
bool network_refresh(palp_network *net);

/* Extrapolates next.x in depth, or in time in a dwell, through the last two states (three if curved), and
 * evaluates. False if extrapolation is not possible or fails. */
bool network_extrapolate(palp_network *net, double depth, double time, bool curved);

/* ---- network.c ---- */

/* What a model says about these settings. */
void network_take_settings(const palp_model *model, palp_network_settings *settings);

/* Gives the springs damage and resets the network. *damage belongs to the caller and must stay. */
palp_status network_set_damage(palp_network *net, const element_damage *damage);

/* ---- terms of the core ---- */

/* The mass terms of time integration; NULL: out of memory. */
network_term *network_inertia_new(const palp_network *net);

/* Weight of the nodes' mass, m/s^2; NULL: out of memory. */
network_term *network_gravity_new(const double acceleration_m_s2[3]);

/* Springs that resist motion of the free axes of a node set. Stiffness: share times that of the node's
 * elements at rest. Calls add up. */
palp_status network_set_foundation(palp_network *net, const char *set, double share);

/* Stiffness of these springs [3 n_nodes], N/m, or NULL. */
const double *network_foundation(const palp_network *net);

/* Cells or tetrahedra that resist a change of volume (network_volume.c), as the settings say.
 * ERR_UNSUPPORTED: the mesh has none, a flat one, or one with an edge or diagonal that is no element. */
palp_status network_add_volume(palp_network *net);
bool network_has_volume(const palp_network *net);

/* Is there an element between any two corners of a solid, and is none of them cut? */
bool network_is_solid_joined(const palp_mesh *mesh, size_t corners, const int32_t *node);
bool network_is_solid_whole(const palp_network *net, size_t corners, const int32_t *node);

/* Fibres of the regions that have some (network_fibre.c). ERR_UNSUPPORTED as network_add_volume. */
palp_status network_add_fibres(palp_network *net);
bool network_has_fibres(const palp_network *net);

#endif
