/* visual.h: a fine surface to draw, which a network carries along. Stable. */
#ifndef PALPATE_VISUAL_H
#define PALPATE_VISUAL_H

#include <palpate/network.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct palp_visual palp_visual; /* opaque; palp_visual_free */

/* Binds vertices x_m[3 n_vertices], with the network at rest, to its tetrahedra: each has fixed barycentric
 * coordinates in the one it is in, or else in the nearest. triangles[3 n_triangles]: vertices. Copies; the
 * caller owns *visual. error may be NULL. ERR_INPUT with a line in error: a vertex that does not exist, a
 * number that is not finite; ERR_UNSUPPORTED: a network without tetrahedra; ERR_NO_MEMORY. */
PALP_API palp_status palp_visual_create(const palp_network *network, size_t n_vertices, const double *x_m,
                                        size_t n_triangles, const int32_t *triangles, palp_visual **visual,
                                        palp_error *error);
PALP_API void palp_visual_free(palp_visual *visual); /* NULL is fine */

/* Places and unit normals of the vertices at the network's last committed state, [3 n_vertices] each; normal
 * may be NULL. network: the one it was made for, or one of the same mesh. Normals are those of the triangles
 * around, weighed by area; 0 where there are none. Allocates nothing. In a network that can be cut
 * (palpate/cut.h) a vertex follows the part of its tetrahedron that it is in. Triangles across a cut are left
 * out. ERR_ARGUMENT: a network of another mesh. */
PALP_API palp_status palp_visual_follow(palp_visual *visual, const palp_network *network, double *x_m,
                                        double *normal);
PALP_API palp_status palp_visual_follow_float(palp_visual *visual, const palp_network *network, float *x_m,
                                              float *normal);

/* The triangles to draw after the last follow, [3 *n], the visual's, valid until the next follow. *version,
 * which may be NULL, changes whenever they do. */
PALP_API palp_status palp_visual_triangles(const palp_visual *visual, size_t *n, const int32_t **triangles,
                                           size_t *version);

#ifdef __cplusplus
}
#endif
#endif
