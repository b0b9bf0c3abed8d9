/* relaxation_parameters.h: what the relaxation stage fits, and a material by its parameters. Internal. */
#ifndef RELAXATION_PARAMETERS_H
#define RELAXATION_PARAMETERS_H

#include <palpate/calibrate.h>

enum { RELAXATION_PARAMETERS_MAX = 1 + 4 * PALP_ARMS_MAX };

typedef enum relaxation_role {
    RELAXATION_SCALE, /* of the law */
    RELAXATION_STIFFNESS,
    RELAXATION_LOG_TIME,
    RELAXATION_BETA,
    RELAXATION_GAMMA
} relaxation_role;

typedef struct relaxation_parameter {
    relaxation_role role;
    size_t first, last; /* arms, inclusive */
} relaxation_parameter;

/* Fills list[RELAXATION_PARAMETERS_MAX]; how many. */
size_t relaxation_list(const palp_material *start, const palp_relaxation_settings *settings,
                       relaxation_parameter *list);

/* p[n] of the material `start`. */
void relaxation_first_guess(size_t n, const relaxation_parameter *list, const palp_material *start,
                            double *p);

/* The material of p[n], start's but for what is fitted; what palp_material_check says of it. */
palp_status relaxation_material(size_t n, const relaxation_parameter *list, const palp_material *start,
                                const double *p, palp_material *material);

/* Bounds as linear constraints row . p >= floor, row[2 n n] by rows, floor[2 n]; how many. longest: time of
 * the longest record, s: an arm much softer, quicker or slower than the records can tell would never come
 * back from there. */
size_t relaxation_bounds(size_t n, const relaxation_parameter *list, const palp_material *start,
                         double longest, double *row, double *floor);

#endif
