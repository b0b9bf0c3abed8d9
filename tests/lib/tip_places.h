/* tip_places.h: the rows of data/tips/places.csv, for tests and benches. */
#ifndef TIP_PLACES_H
#define TIP_PLACES_H

#include <stdbool.h>
#include <stdio.h>

/* A force of CalculiX over G times the square of the height; lengths in mm. */
typedef struct tip_place {
    char face[8]; /* top: x and z from two edges of it; side: x above the floor */
    double radius, length, x, z, poisson, depth, force;
} tip_place;

/* The file behind its first line; NULL: there is none. */
static inline FILE *tip_places_open(void) {
    FILE *file = fopen("data/tips/places.csv", "r");
    if (file && fscanf(file, "%*[^\n]") == 0)
        return file;
    if (file)
        fclose(file);
    return NULL;
}

/* The next row to compare with. */
static inline bool tip_place_read(FILE *file, tip_place *r) {
    while (fscanf(file, " %7[^,],%lf,%lf,%lf,%lf,%lf,%lf,%*d,%*f,%lf", r->face, &r->radius, &r->length, &r->x,
                  &r->z, &r->poisson, &r->depth, &r->force) == 8)
        if (r->force > 0.0)
            return true;
    return false;
}

#endif
