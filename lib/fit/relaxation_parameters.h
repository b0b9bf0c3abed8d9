/* relaxation_parameters.h: the parameters of the relaxation stage, and a material from them. Internal. */
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

/* The material of p[n], with start's other parameters; the status of palp_material_check. */
palp_status relaxation_material(size_t n, const relaxation_parameter *list, const palp_material *start,
                                const double *p, palp_material *material);

/* Bounds as linear constraints row . p >= floor, row[2 n n] by rows, floor[2 n]; how many. longest: time of
 * the longest record, s: the solver could not bring back an arm far softer, quicker or slower than the
 * records show. */
size_t relaxation_bounds(size_t n, const relaxation_parameter *list, const palp_material *start,
                         double longest, double *row, double *floor);

#endif
