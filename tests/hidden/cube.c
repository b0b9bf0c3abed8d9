/* cube.c: a specimen of particles: 3 x 3 x 3 nodes in a cube. Every pair of neighbours along edges and
 * diagonals has an element: the law beside the arms, by its own strain. Both end faces are held by the
 * plates. It stays as symmetric as it is pressed, so only the middle layer bulges: its edge nodes by one
 * number, its corner nodes by another. Lengths are in spacings of the nodes. */
#include "hidden.h"

#include <math.h>
#include <string.h>

/* Elements that are alike: how many; from a held node to the middle layer, or within it; their two lateral
 * components, each a number, a share of the edge's bulge and one of the corner's. */
typedef struct bundle {
    double n, rest;
    bool across;
    double side[2][3];
} bundle;

#define ROOT2 1.4142135623730951
#define ROOT3 1.7320508075688772

static const bundle bundles[CUBE] = {
    {2, 1, true, {{0, 0, 0}, {0, 0, 0}}}, /* held centre, edge, corner to the node below */
    {8, 1, true, {{0, 1, 0}, {0, 0, 0}}},      {8, 1, true, {{0, 0, 1}, {0, 0, 1}}},
    {8, ROOT2, true, {{1, 1, 0}, {0, 0, 0}}}, /* centre to edge, and so on: diagonals of faces */
    {8, ROOT2, true, {{1, 0, 0}, {0, 0, 0}}},  {16, ROOT2, true, {{0, 0, 1}, {1, 0, 1}}},
    {16, ROOT2, true, {{0, 1, 0}, {1, 0, 0}}}, {8, ROOT3, true, {{1, 0, 1}, {1, 0, 1}}}, /* of space */
    {8, ROOT3, true, {{1, 0, 0}, {1, 0, 0}}},  {16, ROOT3, true, {{1, 0, 0}, {1, 1, 0}}},
    {4, 1, false, {{1, 1, 0}, {0, 0, 0}}}, /* within the middle layer */
    {8, 1, false, {{0, -1, 1}, {1, 0, 1}}},    {4, ROOT2, false, {{1, 0, 1}, {1, 0, 1}}},
    {4, ROOT2, false, {{1, 1, 0}, {1, 1, 0}}},
};

/* A bundle as it is pulled: its length's derivatives by the edge's and the corner's bulge and by the distance
 * of the layers, and the second ones by the bulges. */
typedef struct pulled {
    double strain, d[3], dd[3];
} pulled;

static pulled pull(const bundle *b, const double bulge[2], double apart) {
    double square = b->across ? apart * apart : 0, by[2] = {0, 0}, twice[3] = {0, 0, 0};
    for (int i = 0; i < 2; i++) {
        const double *s = b->side[i];
        double x = s[0] + s[1] * bulge[0] + s[2] * bulge[1];
        square += x * x;
        by[0] += x * s[1], by[1] += x * s[2];
        twice[0] += s[1] * s[1], twice[1] += s[1] * s[2], twice[2] += s[2] * s[2];
    }
    double length = sqrt(square), a = by[0] / length, c = by[1] / length;
    return (pulled){
        .strain = length / b->rest - 1,
        .d = {a, c, b->across ? apart / length : 0},
        .dd = {(twice[0] - a * a) / length, (twice[1] - a * c) / length, (twice[2] - c * c) / length}};
}

/* Force and stiffness of an element at the end of a step; q: of its arms, by the implicit midpoint rule. */
static double element(const world *w, const cube *c, size_t k, double step, double e, double *stiffness,
                      double q[ARMS]) {
    double u = fabs(e), law = 0, slope = 0;
    for (int i = LAW; i-- > 0;) {
        slope = slope * u + law;
        law = law * u + w->law[i];
    }
    double force = law * e;
    *stiffness = law + u * slope;
    for (size_t j = 0; j < w->n_arms; j++) {
        double x = 0.5 * step / w->arms[j].time, take = w->arms[j].stiffness / (1 + x);
        q[j] = (1 - x) / (1 + x) * c->arm_force[k][j] + take * (e - c->strain[k]);
        force += q[j];
        *stiffness += take;
    }
    return force;
}

/* Out-of-balance forces of the two bulges (r), their slopes (rr) and the force on the plate, into end. */
static double balance(const world *w, const cube *c, double step, double apart, cube *end, double r[2],
                      double rr[3]) {
    double plate = 0, stiffness;
    memset(r, 0, 2 * sizeof *r);
    memset(rr, 0, 3 * sizeof *rr);
    for (size_t k = 0; k < CUBE; k++) {
        const bundle *b = &bundles[k];
        pulled p = pull(b, end->bulge, apart);
        double force = b->n * element(w, c, k, step, p.strain, &stiffness, end->arm_force[k]);
        double s = b->n * stiffness / b->rest;
        end->strain[k] = p.strain;
        r[0] += force * p.d[0];
        r[1] += force * p.d[1];
        rr[0] += force * p.dd[0] + s * p.d[0] * p.d[0];
        rr[1] += force * p.dd[1] + s * p.d[0] * p.d[1];
        rr[2] += force * p.dd[2] + s * p.d[1] * p.d[1];
        plate -= 0.5 * force * p.d[2];
    }
    return plate;
}

double cube_press(const world *w, const cube *c, double step, double e, cube *end) {
    double r[2], rr[3], force = 0;
    *end = *c;
    for (int i = 0; i < 30; i++) {
        force = balance(w, c, step, 1 - e, end, r, rr);
        double det = rr[0] * rr[2] - rr[1] * rr[1];
        double move[2] = {(rr[1] * r[1] - rr[2] * r[0]) / det, (rr[1] * r[0] - rr[0] * r[1]) / det};
        if (!(fabs(move[0]) + fabs(move[1]) > 1e-11))
            break;
        end->bulge[0] += move[0];
        end->bulge[1] += move[1];
    }
    return force;
}
