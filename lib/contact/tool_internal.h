/* tool_internal.h: what tools, their contacts and held nodes share. Internal. */
#ifndef TOOL_INTERNAL_H
#define TOOL_INTERNAL_H

#include "network/network_internal.h"

#include <palpate/tool.h>

/* A point of the surface near a tool: a node, or the point of a triangle that is nearest to the tool. A capsule
 * meets a triangle as the sphere at one place of its axis, which stays for a step. */
typedef struct contact {
    int32_t tool, node[3]; /* a node's contact has corners = 1, node[1] = node[2] = -1 */
    int32_t corners;
    double along;          /* place of that sphere on the capsule's axis, m */
    double stiffness;      /* N/m */
    double grip[3];        /* barycentric coordinates of the point that friction holds, for a step */
    double anchor[3];      /* friction's spring starts here and goes with the tool */
    bool touched;          /* in the committed state */
    double entry;          /* share of the step that it has been touching for */
    /* of the last evaluation */
    double depth, pressure; /* m, N */
    double share[3];       /* barycentric coordinates of the nearest point */
    double gradient[3][3]; /* of the shares on the triangle, 1/m; on an edge or in a corner those of the edge, none */
    double distance;       /* from the point to the sphere's centre, negative if that is below the triangle, m */
    double point[3];
    double push[3];        /* the way the tool pushes the tissue */
    double normal[6];      /* tangent of the pressure at fixed shares: lower triangle xx yx yy zx zy zz */
    double stretch[3];     /* of friction's spring, m */
    double rub[3];         /* force of friction on the tissue, N */
    double across[6];      /* its tangent */
    double force[3], tangent[6]; /* pressure and friction together, for who takes them at one point */
} contact;

/* What a state remembers: the contacts that touched, with friction's springs, */
typedef struct load_touch {
    int32_t tool, node[3];
    double stretch[3];
} load_touch;

/* the nodes that are held, */
typedef struct load_hold {
    double target[3], was[3]; /* where to; where the hand was at the last committed state */
    double force[3];          /* on the hand */
    int32_t node;
} load_hold;

/* the tools, */
typedef struct load_tool {
    palp_tool pose;
    palp_tool_force felt;
} load_tool;

/* and how many of each: the head of network_state.load, before [max_tools], [max_held], [max_contacts] of them. */
typedef struct load_memory {
    size_t n_tools, n_holds, n_touches;
} load_memory;

struct network_load {
    palp_contact_settings settings;
    size_t max_tools, max_held, max_contacts;
    size_t n_tools;
    palp_tool *tool;         /* [max_tools] as set */
    palp_tool *pose;         /* [max_tools] as the present evaluation has them */
    double *target;          /* [3 max_held] likewise, of held nodes */
    double share;            /* of their way from the last committed state */
    contact *contact;        /* [max_contacts] */
    size_t n_contacts;
    double edge;             /* mean edge of the surface at rest, m */
    double modulus;          /* instantaneous stiffness of an element at rest, N */
    double *unit;            /* [n_nodes] a node's own stiffness over that of an element, 1/m */
    int32_t *triangles;      /* [n_nodes] of the surface that meet in a node */
    size_t surface_changes;  /* of the surface that they are counted on */
    size_t *first;           /* [n_nodes + 1] */
    int32_t *element;        /* [2 n_elements] of node i: from first[i] to first[i + 1] */
    double *force;           /* [3 n_nodes] */
    double *weight;          /* [n_nodes] scratch */
    double size;
};

load_memory *load_memory_of(const network_state *state);
load_tool *load_tools(const network_state *state);
load_hold *load_holds(const network_load *load, const network_state *state);
load_touch *load_touches(const network_load *load, const network_state *state);
size_t load_memory_size(const network_load *load);

/* N/m of a penalty spring of a node. */
double load_hold_stiffness(const network_load *load, int32_t node);

/* Fills load->contact with what is near the tools at x; anchors are set from net->now. */
void contact_find(palp_network *net, const double *x);

/* How far along a capsule the place that is nearest to the contact's triangle now is from where it is taken, m. */
double contact_slid(const palp_network *net, const contact *c);

/* Force and tangent at net->next.x. */
void contact_evaluate(const palp_network *net, contact *c);

/* out += -d force / d x times u, both [3 n_nodes]. */
void contact_times(const contact *c, const double *u, double *out);

/* k[9] = -d force on corner a / d corner b, by rows. */
void contact_block(const contact *c, int a, int b, double k[9]);

/* Potential of its pressure, J. */
double contact_energy(const network_load *load, const contact *c);

/* Depth, push, share, distance, gradient with the tool in this pose and nodes at x. */
void contact_measure(const palp_tool *tool, contact *c, const double *x);

/* Barycentric coordinates of the point of a triangle that is nearest to p. */
void contact_nearest(const double *const corner[3], const double p[3], double share[3]);

/* Sum of share[i] times what its nodes have in x[3 n_nodes]. */
void contact_point(const contact *c, const double share[3], const double *x, double point[3]);

static inline double dot3(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void cross3(const double *a, const double *b, double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* a + s b */
static inline void along3(const double *a, double s, const double *b, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[k] + s * b[k];
}

#endif
