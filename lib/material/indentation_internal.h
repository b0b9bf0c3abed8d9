/* indentation_internal.h: factor of the force for what a wide layer at small strain leaves out. Internal. */
#ifndef INDENTATION_INTERNAL_H
#define INDENTATION_INTERNAL_H

#include <palpate/indentation.h>

/* Do the tables cover this indentation? ERR_UNSUPPORTED, ERR_LIMIT. */
palp_status indentation_factor_check(const palp_indentation *indentation, double deepest_m);

/* Force over that of a wide layer at small strain. */
double indentation_factor(const palp_indentation *indentation, double depth_m);

/* Radius of the smallest flat punch in the tables, m. */
double indentation_smallest_punch(const palp_indentation *indentation);

#endif
