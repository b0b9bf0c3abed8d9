/* cut.h: cutting and tearing a network while it runs, and the surface that is left to draw. Stable. */
#ifndef PALPATE_CUT_H
#define PALPATE_CUT_H

#include <palpate/network.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Cuts take effect with the next step and drop a trial that is not committed. A cut element bears no force
 * and has no strain. What no support and no grasp holds in place any more (palp_network_loose) is kept where
 * it is by weak springs to its last committed place: it can be pushed aside and stays where it came to rest.
 * palp_network_reset and _set_material make everything whole again. None of the calls below but enable
 * allocates. */

/* Makes a network ready to be cut; all memory is allocated here, and is the network's. Once. ERR_ARGUMENT:
 * done before; ERR_NO_MEMORY; ERR_UNSUPPORTED: its tools touch a subdivided surface. */
PALP_API palp_status palp_network_enable_cutting(palp_network *network);

/* Cuts every element that the triangle corners_m[9] (three points, m) crosses at the committed positions;
 * *n_cut (may be NULL) counts them. A blade that swept from one edge to another is two triangles; tissue
 * moves between steps, so a sweep should overlap the one before. A node exactly on the blade is on one side
 * of it for all its elements, the same whatever the order of the corners. A triangle without area cuts
 * nothing. ERR_ARGUMENT: not enabled, a corner that is not finite. */
PALP_API palp_status palp_network_cut(palp_network *network, const double corners_m[9], size_t *n_cut);

/* Cuts these elements; one that is cut already stays so. ERR_ARGUMENT: not enabled, an index out of range. */
PALP_API palp_status palp_network_cut_elements(palp_network *network, size_t n, const int32_t *elements);

/* Elements stretched beyond an element strain (L / L0 - 1), or pulled beyond force_N, tear. 0 = never, as it
 * is at first. ERR_ARGUMENT: not enabled, a negative limit or one that is not finite. */
PALP_API palp_status palp_network_set_tearing(palp_network *network, double strain, double force_N);

/* Tears what is beyond the limits at the committed state; to be called after a step. *n_torn (may be NULL)
 * counts them. ERR_ARGUMENT: not enabled. */
PALP_API palp_status palp_network_tear(palp_network *network, size_t *n_torn);

/* alive[n_elements]: 1 = whole, 0 = cut; the network's, valid until it is freed; NULL: not enabled. */
PALP_API const unsigned char *palp_network_alive(const palp_network *network);

/* Nodes that no chain of whole elements ties to one with a fixed or driven axis, or to a grasped one:
 * loose[n_nodes] = 1 (may be NULL); returns how many. */
PALP_API size_t palp_network_loose(const palp_network *network, unsigned char *loose);

#ifdef __cplusplus
}
#endif
#endif
