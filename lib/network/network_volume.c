/* network_volume.c: cells or tetrahedra that resist a change of volume, which springs between nodes do not.
 * J is the volume over that at rest. Energy per volume at rest: w(J) = k (J - 1 - ln J), near rest
 * k (J - 1)^2 / 2, infinite at J = 0. A hexahedron has one J: six tetrahedra with their own would lock. k and
 * the volume of a crooked cell are derived in doc/numerics.md. */
#include "base/clones.h"
#include "mesh/mesh_internal.h"
#include "network_internal.h"

#include <math.h>
#include <string.h>

static const double LEAST =
    0.05; /* Below this J w continues as a parabola, as trial positions may be inverted */

/* A tetrahedron's volume depends on three modes of its corners: its edges from the first one. That of a cell,
 * whose corner c is at x = c & 1, y = c >> 1 & 1, z = c >> 2, depends on six: its edges in the mean, and
 * their changes across xy, xz, yz. The volume is the sum of factor det(three modes); tetrahedra have the
 * first. */
enum { CORNERS = 8, MODES = 6, TRIPLES = 4, BATCH = 4 };
static const unsigned char of_axes[MODES] = {1, 2, 4, 3, 5, 6};
static const unsigned char triple[TRIPLES][3] = {{0, 1, 2}, {0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
static const double factor_of_triple[TRIPLES] = {1.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0};

/* The same number of several solids. */
typedef double lanes __attribute__((vector_size(BATCH * sizeof(double)), aligned(sizeof(double)), may_alias));

typedef struct volume {
    network_term term;
    double modulus;    /* k of the network's own material, Pa */
    double *all_k, *k; /* [n_all] and, of those in use, [n_all + BATCH] that of each solid; 0 behind n */
    double volume_m3, length_m; /* of the body and network_shared_length, both whole and of all parts */
    size_t corners, modes;      /* of a solid: 8 and 6, or 4 and 3 */
    size_t n_all, n, changes; /* solids; those without a cut element; surface_changes when they were found */
    int32_t *all, *node;      /* [corners n_all] and, of those in use, [corners (n_all + BATCH)] */
    double *all_rest, *rest;  /* [n_all], [n_all + BATCH] m^3 */
    double squares;           /* of stiffness times position, at rest, N^2 */
    double unit;              /* volume over the sum of these determinants */
    double sign[MODES][CORNERS];          /* a mode is the sum of sign times corner */
    double turn[CORNERS][CORNERS][MODES]; /* the volume's second derivative by corners a and b is u (v x sum
                                             of turn times mode) */
    double *mode;                         /* [3 modes (n_all + BATCH)] by batches, at the last evaluation */
    double *ratio, *slope, *curve; /* [n_all + BATCH] J; unit dw/dJ, Pa; unit^2 d2w/dJ2 over the volume at
                                      rest, Pa/m^3 */
} volume;

/* w at a ratio J. */
static double volume_energy_density(double k, double ratio) {
    const double at = fmax(ratio, LEAST), beyond = ratio - at;
    return k * (at - 1.0 - log(at) + (1.0 - 1.0 / at + 0.5 * beyond / (at * at)) * beyond);
}

/* ---- batches ------------------------------------------------------------------------------------- */

/* The functions below are made for each kind of solid and, in PALP_CLONES, of processor. */
#define INLINE static inline __attribute__((always_inline))

/* out += f a x b */
INLINE void add_cross(double f, const lanes *a, const lanes *b, lanes *out) {
    out[0] += f * (a[1] * b[2] - a[2] * b[1]);
    out[1] += f * (a[2] * b[0] - a[0] * b[2]);
    out[2] += f * (a[0] * b[1] - a[1] * b[0]);
}

/* g = the volume's derivative by each mode. */
INLINE void find_gradient(size_t modes, const lanes *m, lanes *g) {
    for (size_t i = 0; i < 3 * modes; i++)
        g[i] = (lanes){0.0};
    for (size_t t = 0; t < (modes == MODES ? TRIPLES : 1); t++)
        for (size_t i = 0; i < 3; i++)
            add_cross(factor_of_triple[t], m + 3 * triple[t][(i + 1) % 3], m + 3 * triple[t][(i + 2) % 3],
                      g + 3 * triple[t][i]);
}

/* g = the gradient's change with the modes by dm. */
INLINE void find_gradient_change(size_t modes, const lanes *m, const lanes *dm, lanes *g) {
    for (size_t i = 0; i < 3 * modes; i++)
        g[i] = (lanes){0.0};
    for (size_t t = 0; t < (modes == MODES ? TRIPLES : 1); t++)
        for (size_t i = 0; i < 3; i++) {
            const size_t a = 3 * triple[t][(i + 1) % 3], b = 3 * triple[t][(i + 2) % 3];
            add_cross(factor_of_triple[t], dm + a, m + b, g + 3 * triple[t][i]);
            add_cross(factor_of_triple[t], m + a, dm + b, g + 3 * triple[t][i]);
        }
}

INLINE void dot(size_t n, const lanes *a, const lanes *b, lanes *sum) {
    *sum = a[0] * b[0];
    for (size_t i = 1; i < n; i++)
        *sum += a[i] * b[i];
}

/* Modes of cells along an axis, whose corners are at c, and forces on the corners by forces on the modes. */
INLINE void find_cell_modes(const lanes *c, lanes *m) {
    const lanes d0 = c[1] - c[0], d1 = c[3] - c[2], d2 = c[5] - c[4], d3 = c[7] - c[6];
    const lanes s0 = c[1] + c[0], s1 = c[3] + c[2], s2 = c[5] + c[4], s3 = c[7] + c[6];
    m[0] = d0 + d1 + (d2 + d3);
    m[3] = s1 - s0 + (s3 - s2);
    m[6] = s2 + s3 - (s0 + s1);
    m[9] = d1 - d0 + (d3 - d2);
    m[12] = d2 + d3 - (d0 + d1);
    m[15] = s0 - s1 + (s3 - s2);
}

INLINE void find_cell_forces(const lanes *f, lanes *c) {
    const lanes d0 = f[0] - f[9], d1 = f[0] + f[9], e = f[12], s0 = f[3] + f[6], s1 = f[3] - f[6], t = f[15];
    const lanes d[4] = {d0 - e, d1 - e, d0 + e, d1 + e}, s[4] = {t - s0, s1 - t, -(s1 + t), s0 + t};
    for (size_t i = 0; i < 4; i++) {
        c[2 * i] = s[i] - d[i];
        c[2 * i + 1] = s[i] + d[i];
    }
}

/* Modes of a batch of solids, for vectors x[3 n_nodes]. */
INLINE void gather_modes(size_t corners, const int32_t *node, const double *x, lanes *m) {
    const int32_t *second = node + corners, *third = second + corners, *fourth = third + corners;
    for (size_t k = 0; k < 3; k++) {
        lanes c[CORNERS] = {{0.0}};
        for (size_t i = 0; i < corners; i++) {
            const double of_each[BATCH] = {x[3 * (size_t)node[i] + k], x[3 * (size_t)second[i] + k],
                                           x[3 * (size_t)third[i] + k], x[3 * (size_t)fourth[i] + k]};
            memcpy(c + i, of_each, sizeof of_each);
        }
        if (corners == CORNERS)
            find_cell_modes(c, m + k);
        for (size_t i = 0; i < 3 && corners < CORNERS; i++)
            m[3 * i + k] = c[i + 1] - c[0];
    }
}

/* out -= what forces f on the modes are on the corners. */
INLINE void subtract_on_corners(size_t corners, const int32_t *node, const lanes *f, double *out) {
    for (size_t k = 0; k < 3; k++) {
        lanes c[CORNERS] = {{0.0}};
        if (corners == CORNERS)
            find_cell_forces(f + k, c);
        for (size_t i = 0; i < 3 && corners < CORNERS; i++) {
            c[i + 1] = f[3 * i + k];
            c[0] -= c[i + 1];
        }
        for (size_t i = 0; i < BATCH; i++)
            for (size_t j = 0; j < corners; j++)
                out[3 * (size_t)node[corners * i + j] + k] -= c[j][i];
    }
}

/* ---- the term ------------------------------------------------------------------------------------ */

/* Elements of other parts are not cut. */
static bool is_whole(const palp_network *net, size_t element) {
    return element == net->n_elements || net->scale[element] > 0.0;
}

bool network_is_solid_whole(const palp_network *net, size_t corners, const int32_t *node) {
    for (size_t a = 0; a < corners && net->scale; a++)
        for (size_t b = 0; b < a; b++)
            if (!is_whole(net, palp_mesh_element_between(net->mesh, node[a], node[b])))
                return false;
    return true;
}

/* Solids without a cut element, in the mesh's order; the last batch is filled up with one of them. */
static void find_whole_solids(volume *t, const palp_network *net) {
    const size_t corners = t->corners;
    t->n = 0;
    t->squares = 0.0;
    for (size_t i = 0; i < t->n_all; i++) {
        const int32_t *node = t->all + corners * i;
        if (!network_is_solid_whole(net, corners, node))
            continue;
        memcpy(t->node + corners * t->n, node, corners * sizeof *node);
        const double *place = net->rest + 3 * (size_t)node[0];
        t->squares += pow(1.5 * t->all_k[i], 2.0) * pow(t->all_rest[i], 2.0 / 3.0) *
                      network_dot(place, place, 3); /* of a cube */
        t->k[t->n] = t->all_k[i];
        t->rest[t->n++] = t->all_rest[i];
    }
    for (size_t i = t->n; i % BATCH != 0; i++) {
        memcpy(t->node + corners * i, t->node + corners * (t->n - 1), corners * sizeof *t->node);
        t->rest[i] = t->rest[t->n - 1];
        t->k[i] = 0.0;
    }
    t->changes = net->surface_changes;
}

/* J, slope and curve of the batch at this solid, whose sums of determinants these are. Solids that fill it up
 * have no modulus. */
INLINE void find_slopes(volume *t, size_t at, const lanes *determinants, lanes *slope) {
    lanes rest, ratio, least, k, inverse;
    memcpy(&rest, t->rest + at, sizeof rest);
    memcpy(&k, t->k + at, sizeof k);
    k *= t->unit;
    ratio = t->unit * *determinants / rest;
    for (size_t i = 0; i < BATCH; i++)
        least[i] = ratio[i] > LEAST ? ratio[i] : LEAST;
    inverse = 1.0 / least;
    *slope = k * (1.0 - inverse + (ratio - least) * inverse * inverse);
    k *= t->unit * inverse * inverse / rest;
    memcpy(t->ratio + at, &ratio, sizeof ratio);
    memcpy(t->slope + at, slope, sizeof *slope);
    memcpy(t->curve + at, &k, sizeof k);
}

INLINE void evaluate_solids(volume *t, size_t corners, size_t modes, const double *x, double *out) {
    for (size_t at = 0; at < t->n; at += BATCH) {
        const int32_t *node = t->node + corners * at;
        lanes g[3 * MODES], sum, slope, *m = (lanes *)(t->mode + 3 * modes * at);
        gather_modes(corners, node, x, m);
        find_gradient(modes, m, g);
        dot(3 * modes, m, g, &sum);
        sum /= 3.0;
        find_slopes(t, at, &sum, &slope);
        for (size_t i = 0; i < 3 * modes; i++)
            g[i] *= slope;
        subtract_on_corners(corners, node, g, out);
    }
}

PALP_CLONES
static void evaluate_batches(volume *t, const double *x, double *out) {
    if (t->corners == CORNERS)
        evaluate_solids(t, CORNERS, MODES, x, out);
    else
        evaluate_solids(t, 4, 3, x, out);
}

static void evaluate_volume_forces(network_term *term, palp_network *net) {
    volume *t = (volume *)term;
    if (t->changes != net->surface_changes)
        find_whole_solids(t, net);
    evaluate_batches(t, net->next.x, net->outer);
    net->outer_squares += t->squares;
}

static bool add_volume_energy(const network_term *term, const palp_network *net, double *energy) {
    const volume *t = (const volume *)term;
    (void)net;
    for (size_t i = 0; i < t->n; i++)
        *energy += t->rest[i] * volume_energy_density(t->k[i], t->ratio[i]);
    return true;
}

INLINE void multiply_solids(const volume *t, size_t corners, size_t modes, const double *u, double *out) {
    for (size_t at = 0; at < t->n; at += BATCH) {
        const int32_t *node = t->node + corners * at;
        const lanes *m = (const lanes *)(t->mode + 3 * modes * at);
        lanes g[3 * MODES], du[3 * MODES], more[3 * MODES], slope, curve, along;
        gather_modes(corners, node, u, du);
        find_gradient(modes, m, g);
        find_gradient_change(modes, m, du, more);
        memcpy(&slope, t->slope + at, sizeof slope);
        memcpy(&curve, t->curve + at, sizeof curve);
        dot(3 * modes, g, du, &along);
        curve *= along;
        for (size_t i = 0; i < 3 * modes; i++)
            more[i] = -(curve * g[i] + slope * more[i]);
        subtract_on_corners(corners, node, more, out);
    }
}

PALP_CLONES
static void multiply_batches(const volume *t, const double *u, double *out) {
    if (t->corners == CORNERS)
        multiply_solids(t, CORNERS, MODES, u, out);
    else
        multiply_solids(t, 4, 3, u, out);
}

static void multiply_volume_tangent(const network_term *term, const palp_network *net, const double *u,
                                    double *out) {
    (void)net;
    multiply_batches((const volume *)term, u, out);
}

/* Modes of solid i at the last evaluation, and its volume's derivative by each corner, over unit. */
static void find_modes_and_gradient(const volume *t, size_t i, double m[MODES][3], double g[CORNERS][3]) {
    const double *batch = t->mode + 3 * t->modes * (i - i % BATCH) + i % BATCH;
    lanes all[3 * MODES], by_mode[3 * MODES];
    for (size_t k = 0; k < 3 * t->modes; k++) {
        m[k / 3][k % 3] = batch[BATCH * k];
        all[k] = (lanes){batch[BATCH * k]};
    }
    find_gradient(t->modes, all, by_mode);
    for (size_t a = 0; a < t->corners; a++)
        for (size_t k = 0; k < 3; k++) {
            g[a][k] = 0.0;
            for (size_t j = 0; j < t->modes; j++)
                g[a][k] += t->sign[j][a] * by_mode[3 * j + k][0];
        }
}

/* Block of corners a and b: curve g g' and slope times the second derivative. */
static void block_of_corners(const volume *t, size_t i, double m[MODES][3], double g[CORNERS][3], size_t a,
                             size_t b, double k[9]) {
    double s[3] = {0.0};
    for (size_t j = 0; j < t->modes; j++)
        for (size_t c = 0; c < 3; c++)
            s[c] += t->slope[i] * t->turn[a][b][j] * m[j][c];
    for (size_t c = 0; c < 9; c++)
        k[c] = t->curve[i] * g[a][c / 3] * g[b][c % 3];
    k[1] += s[2];
    k[2] -= s[1];
    k[3] -= s[2];
    k[5] += s[0];
    k[6] += s[1];
    k[7] -= s[0];
}

static void take_part_of_volume_blocks(const network_term *term, const palp_network *net, size_t part,
                                       size_t parts, network_block_taker take, void *user) {
    const volume *t = (const volume *)term;
    double m[MODES][3], g[CORNERS][3], k[9];
    (void)net;
    for (size_t i = t->n * part / parts; i < t->n * (part + 1) / parts; i++) {
        const int32_t *node = t->node + t->corners * i;
        find_modes_and_gradient(t, i, m, g);
        for (size_t a = 0; a < t->corners; a++)
            for (size_t b = 0; b <= a; b++) {
                block_of_corners(t, i, m, g, a, b, k);
                take(user, node[a], node[b], k);
            }
    }
}

static void take_volume_blocks(const network_term *term, const palp_network *net, network_block_taker take,
                               void *user) {
    take_part_of_volume_blocks(term, net, 0, 1, take, user);
}

/* stiffness: of the springs at rest. */
static double modulus_of_share(const volume *t, const palp_network_settings *s, double share,
                               double stiffness) {
    return s->volume_modulus_Pa > 0.0 ? share * s->volume_modulus_Pa
                                      : share * stiffness * t->length_m / (6.0 * t->volume_m3);
}

static void derive_volume_modulus(network_term *term, palp_network *net) {
    volume *t = (volume *)term;
    const size_t per_solid = t->corners == 4 && mesh_is_all_hexahedra(net->mesh) ? 6 : 1;
    const double *scale = net->ranks ? net->ranks->solid_scale : NULL;
    const palp_network_settings *s = &net->settings;
    double stiffness[PALP_REGIONS_MAX + 1], k[PALP_REGIONS_MAX + 1];
    network_stiffnesses(net, 0.0, false, stiffness);
    t->modulus = modulus_of_share(t, s, network_volume_share(s, 0.0), stiffness[0]);
    for (size_t r = 0; r < net->n_regions; r++) {
        const palp_region *given = &net->region[r].given;
        const double rest = net->region[r].share ? stiffness[r + 1] : given->stiffness * stiffness[0];
        k[r] = given->poisson_ratio > 0.0
                   ? modulus_of_share(t, s, network_volume_share(s, given->poisson_ratio), rest)
                   : t->modulus * rest / stiffness[0];
    }
    k[net->n_regions] = t->modulus;
    for (size_t i = 0; i < t->n_all; i++)
        t->all_k[i] = scale ? modulus_of_share(t, s, scale[i / per_solid], stiffness[0])
                            : t->modulus * (net->edge ? net->edge[i / per_solid] : 1.0);
    if (net->n_regions > 0)
        network_mean_of_solids(net, k, t->n_all, per_solid, t->all_k);
    find_whole_solids(t, net);
}

#define VOLUME_OF(corners)                                                                                   \
    {                                                                                                        \
        .reset = derive_volume_modulus, .evaluate = evaluate_volume_forces, .blocks = take_volume_blocks,    \
        .times = multiply_volume_tangent, .energy = add_volume_energy, .spread = (corners),                  \
        .blocks_part = take_part_of_volume_blocks, .adds_up = true                                           \
    }
static const network_term_kind TETRAHEDRA = VOLUME_OF(4), CELLS = VOLUME_OF(CORNERS);

static volume *find_volume_term(const palp_network *net) {
    network_term *cells = network_find_term(net, &CELLS);
    return (volume *)(cells ? cells : network_find_term(net, &TETRAHEDRA));
}

bool network_has_volume(const palp_network *net) {
    return find_volume_term(net);
}

double palp_network_volume_solids(const palp_network *net, size_t *n, size_t *corners,
                                  const int32_t **nodes) {
    const volume *t = net ? find_volume_term(net) : NULL;
    if (n)
        *n = t ? t->n_all : 0;
    if (corners)
        *corners = t ? t->corners : 0;
    if (nodes)
        *nodes = t ? t->all : NULL;
    return t ? t->modulus : 0.0;
}

const double *palp_network_volume_moduli(const palp_network *net) {
    const volume *t = net ? find_volume_term(net) : NULL;
    return t ? t->all_k : NULL;
}

/* ---- making it ----------------------------------------------------------------------------------- */

bool network_is_solid_joined(const palp_mesh *mesh, size_t corners, const int32_t *node) {
    for (size_t a = 0; a < corners; a++)
        for (size_t b = 0; b < a; b++)
            if (palp_mesh_element_between(mesh, node[a], node[b]) >= mesh->n_elements)
                return false;
    return true;
}

/* signs: the modes as sums over corners. turn: a term of the volume is factor det(i, j, k), with the sums for
 * the modes i, j, k; derived by corner a in one and by b in another it is a determinant with the third. */
static void set_up_modes(volume *t) {
    const bool cells = t->corners == CORNERS;
    t->unit = cells ? 1.0 / 64.0 : 1.0 / 6.0;
    for (size_t j = 0; j < t->modes; j++)
        for (size_t c = 0; c < t->corners; c++) {
            const size_t odd = ~c & of_axes[j];
            t->sign[j][c] = cells    ? ((odd & 1) + (odd >> 1 & 1) + (odd >> 2 & 1)) % 2 ? -1.0 : 1.0
                            : c == 0 ? -1.0
                                     : c == j + 1;
        }
    for (size_t a = 0; a < t->corners; a++)
        for (size_t b = 0; b < t->corners; b++)
            for (size_t n = 0; n < 3 * (cells ? TRIPLES : 1); n++) {
                const unsigned char *mode = triple[n / 3];
                const double *first = t->sign[mode[(n + 1) % 3]], *second = t->sign[mode[(n + 2) % 3]];
                t->turn[a][b][mode[n % 3]] +=
                    factor_of_triple[n / 3] * (first[a] * second[b] - second[a] * first[b]);
            }
}

/* Volume of one solid with its corners at x. */
static double solid_volume(const volume *t, const int32_t *corner, const double *x) {
    int32_t node[BATCH * CORNERS];
    lanes m[3 * MODES], g[3 * MODES], sum;
    for (size_t i = 0; i < BATCH * t->corners; i++)
        node[i] = corner[i % t->corners];
    gather_modes(t->corners, node, x, m);
    find_gradient(t->modes, m, g);
    dot(3 * t->modes, m, g, &sum);
    return t->unit * sum[0] / 3.0;
}

/* Corners and volumes of the mesh's cells, turned over if that makes their volume positive, or tetrahedra. */
static palp_status list_solids(volume *t, const palp_network *net) {
    for (size_t i = 0; i < t->n_all; i++) {
        int32_t *node = t->all + t->corners * i;
        const bool cells = t->corners == CORNERS;
        const int32_t *given = (cells ? net->mesh->hexahedra : net->mesh->tetrahedra) + t->corners * i;
        for (size_t turned = 0; turned < 2 && !(t->all_rest[i] > 0.0); turned++) {
            for (size_t c = 0; c < t->corners; c++)
                node[c] = given[cells ? mesh_gmsh_corner[turned ? c ^ 1 : c] : c];
            t->all_rest[i] = solid_volume(t, node, net->rest);
        }
        if (!(t->all_rest[i] > 0.0) || !(net->ranks || network_is_solid_joined(net->mesh, t->corners, node)))
            return PALP_ERR_UNSUPPORTED;
    }
    return PALP_OK;
}

static palp_status allocate_solids(volume *t, size_t n) {
    arena *memory = &t->term.memory;
    const size_t room = n + BATCH;
    t->all = arena_take(memory, t->corners * room, sizeof *t->all);
    t->node = arena_take(memory, t->corners * room, sizeof *t->node);
    t->mode = arena_take(memory, 3 * t->modes * room, sizeof *t->mode);
    double **of_solid[] = {&t->all_rest, &t->rest, &t->all_k, &t->k, &t->ratio, &t->slope, &t->curve};
    for (size_t i = 0; i < sizeof of_solid / sizeof *of_solid; i++)
        *of_solid[i] = arena_take(memory, room, sizeof **of_solid[i]);
    return memory->failed ? PALP_ERR_NO_MEMORY : PALP_OK;
}

palp_status network_add_volume(palp_network *net) {
    const bool cells = net->settings.volume_modulus_Pa == 0.0 &&
                       (net->ranks ? mesh_is_all_hexahedra(net->mesh) : mesh_has_cells(net->mesh));
    volume *t = network_term_new(cells ? &CELLS : &TETRAHEDRA, sizeof *t);
    if (!t)
        return PALP_ERR_NO_MEMORY;
    t->volume_m3 = network_sum_of_parts(net, mesh_volume(net->mesh, NULL));
    t->length_m = network_sum_of_parts(net, network_shared_length(net));
    t->corners = cells ? CORNERS : 4;
    t->modes = cells ? MODES : 3;
    t->n_all = cells ? net->mesh->n_hexahedra : net->mesh->n_tetrahedra;
    set_up_modes(t);
    const bool joined = net->ranks ? net->ranks->joined : t->n_all > 0;
    palp_status status = joined ? allocate_solids(t, t->n_all) : PALP_ERR_UNSUPPORTED;
    if (!status)
        status = list_solids(t, net);
    status = (palp_status)network_largest_of_parts(net, (double)status);
    if (status)
        network_term_free(&t->term);
    return status ? status : network_add_terms(net, 1, (network_term *[]){&t->term});
}
