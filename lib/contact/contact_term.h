/* contact_term.h: the tools of a network, and the smooth surface between them and its nodes. Internal. */
#ifndef CONTACT_TERM_H
#define CONTACT_TERM_H

#include "contact_internal.h"
#include "skin.h"

/* A contact_set whose points are the vertices of a smooth surface instead of the nodes. */
typedef struct contact_layer {
    skin skin;
    double *x, *committed; /* [3 skin.n] positions of vertices */
    double *in, *out;      /* [3 skin.n] vectors at vertices in contact; out is zero between uses */
    int32_t *near;         /* [skin.n] vertices near tools */
    int32_t *active;       /* [n_active] vertices of contacts */
    bool *is_active;       /* [skin.n] */
    size_t n_active;
    double *block;     /* [9 n_pairs], zero between uses */
    bool *is_touched;  /* [n_pairs] */
    uint32_t *touched; /* [n_pairs] */
    int32_t *stencil;  /* [room] */
    double *share;     /* [3 room] */
    double *half;      /* [27 room] */
    double *patch;     /* [n_surface] of a triangle: what it adds to the local stiffness of each corner of its
                          parts, 1/m; in tissue without regions */
    double *local;     /* [skin.n] that of vertices, with regions */
} contact_layer;

typedef struct contact_term {
    network_term term;
    contact_set set;
    contact_layer *layer;   /* or NULL: the set is on the network's nodes */
    size_t surface_changes; /* count of the network's surface changes when the set was made */
    double *weight;         /* [n_nodes] scratch */
} contact_term;

/* A layer and the set on it; NULL: out of memory. */
contact_layer *layer_new(arena *memory, const palp_network *net, size_t max_tools,
                         const palp_contact_settings *settings, contact_set *set);

/* Distributes the stiffness of the network's nodes, which may have changed, to the vertices. */
void layer_share_stiffness(contact_layer *l, const palp_network *net, contact_set *set);

/* Like the functions of contact_set and of the term, from positions and to forces of the network's nodes. */
void layer_place(contact_layer *l, contact_set *set, double share, const double *now, const double *next);
bool layer_refresh(contact_layer *l, contact_set *set, const double *now, const double *next);
void layer_evaluate(contact_layer *l, contact_set *set, const double *next, double *force, double *squares);
void layer_times(const contact_layer *l, const contact_set *set, contact_product *times, const double *u,
                 double *out);
void layer_blocks(const contact_layer *l, const contact_set *set, network_block_taker take, void *user);

/* Positions of the vertices in contact; others are out of date. */
const double *layer_places(contact_layer *l, const double *next);

/* The nodes and weights of a vertex; returns their number. */
size_t layer_corner(const contact_layer *l, int32_t vertex, const int32_t **node, const double **weight);

#endif
