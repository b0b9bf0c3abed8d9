/* free_term.h: the splines whose sum is a free term, and the place of a path on their grid. Internal. */
#ifndef RESPONSE_FREE_TERM_H
#define RESPONSE_FREE_TERM_H

#include <palpate/forward.h>

enum { FREE_BENDS = PALP_FREE_NODES * PALP_FREE_NODES };

/* Second derivatives at the nodes, bend[node NODES + function], of the natural cubic splines that are 1 at
 * one node and 0 at the others. */
void free_term_bends(double bend[FREE_BENDS]);

/* Values, times size, of all functions at this share of the grid: column[a n + i] of function a. */
void free_term_hats(const double bend[FREE_BENDS], double at, double size, size_t n, size_t i,
                    double *column);

/* The node at which a term of this kind is 0, as the force is continuous where a dwell begins and where a
 * response ends; NODES: there is none. */
size_t free_term_zero(palp_free_kind kind);

/* The forces of a term are these columns[NODES n] times its table. force[n]: of the plate. */
palp_status free_term_columns(const palp_free_term *term, size_t n, const double *time, const double *depth,
                              double height, double session, const double *force, double *column);

#endif
