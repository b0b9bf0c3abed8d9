/* vtu.h: the deforming network for ParaView: VTK XML unstructured grids and a .pvd series. Stable. */
#ifndef PALPATE_VTU_H
#define PALPATE_VTU_H

#include <palpate/network.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct palp_vtu palp_vtu; /* a series being written; palp_vtu_close */

/* Starts a series in a folder (made if need be): folder/name_0000.vtu ... and folder/name.pvd. */
PALP_API palp_status palp_vtu_open(const char *folder, const char *name, palp_vtu **series,
                                   palp_error *error);

/* Writes the network's committed state as the next frame: displaced points, lines as cells, point
 * data "displacement" (m), cell data "strain" (1) and "force_N" (N, tension positive). Of a network in parts
 * (palpate/ranks.h) each process writes one file, and the first a .pvtu of them; all call it. */
PALP_API palp_status palp_vtu_add(palp_vtu *series, const palp_network *network, palp_error *error);

/* Writes the .pvd (temporary name, then rename) and frees the series; NULL is fine. */
PALP_API palp_status palp_vtu_close(palp_vtu *series, palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
