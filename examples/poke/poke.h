/* poke.h: what the files of the poke example share. Lengths in metres, y upwards. */
#ifndef POKE_H
#define POKE_H

#include <palpate/palpate.h>

enum { POKE_CURVE = 600, POKE_GRASPED = 64, POKE_TICKS = 8, POKE_TIMES = 60 * POKE_TICKS };

typedef enum poke_mode { POKE_PRESS, POKE_GRASP, POKE_CUT } poke_mode;

/* ---- body.c: the phantom and what touches it ---- */

typedef struct body {
    palp_network *net;
    palp_realtime *realtime; /* net's */
    void *saved;             /* [saved_size] bytes: net before a tick */
    size_t saved_size;
    const palp_mesh *mesh;  /* net's */
    double low[3], high[3]; /* its box at rest */
    palp_tool sphere;
    bool sphere_on;
    double sphere_goal[3]; /* where it is going, at most at SPEED */
    int32_t grasped[POKE_GRASPED];
    double grasped_from[3 * POKE_GRASPED]; /* where the nodes were grasped */
    double hand[3], hand_goal[3];          /* how far the hand has moved, is to move */
    size_t n_grasped;
    double blade[6]; /* ends of the blade's edge */
    bool blade_on;
    bool tearing;
    size_t n_cut, n_torn;
    double force_N[3];                                   /* of the tissue on the sphere or the hand */
    char region[PALP_REGIONS_MAX][PALP_REGION_NAME_MAX]; /* names of the network's regions */
    size_t n_regions;
    int touched;                /* the region that takes most of the sphere's force, or -1 */
    double curve_N[POKE_CURVE]; /* its size at the last frames, the newest at curve_end - 1 */
    size_t curve_end;
    palp_tick_info tick;             /* of the last tick */
    double tick_seconds[POKE_TIMES]; /* what the ticks of the last second took, the newest at n_ticks - 1 */
    size_t n_ticks;
    double time;
    size_t failed; /* ticks that found no state */
} body;

/* Reads a network model; the bottom is fixed, all other nodes are free. false: a line was printed. */
bool body_open(body *b, const char *path);
void body_close(body *b);
void body_reset(body *b);

/* One frame of seconds in ticks; within: end each by the clock (a window), not by counted work (a script). */
void body_step(body *b, double seconds, bool within);

double body_tick_median(const body *b); /* of the last second's ticks, s */

void body_grasp(body *b, const double at[3],
                double radius); /* surface nodes within the radius, the nearest at least */
void body_release(body *b);

/* Sweeps the blade's edge to new ends and cuts what it crosses. */
void body_slice(body *b, const double edge[6]);

/* The nearest point of the surface along a ray; false if it misses. */
bool body_hit(const body *b, const double from[3], const double along[3], double at[3]);

/* ---- view.c: the camera and the scene ---- */

typedef struct view {
    int width, height; /* pixels */
    double yaw, pitch, distance, centre[3];
} view;

typedef struct scene scene;
scene *scene_create(const body *b); /* NULL: no memory */
void scene_free(scene *s);
void scene_draw(scene *s, const body *b, const view *v);

/* Camera's place and axes, and the ray through a pixel. */
void view_axes(const view *v, double eye[3], double right[3], double up[3], double ahead[3]);
void view_ray(const view *v, double x, double y, double from[3], double along[3]);

/* Metres that a pixel is wide at a point. */
double view_pixel(const view *v, const double at[3]);

/* ---- panel.c: text, the force curve, the legend ---- */

void panel_draw(const body *b, const view *v, poke_mode mode, const char *name);
double scene_colour(double strain, double rgb[3]); /* the colours' range: strain of the last colour */

/* ---- script.c: a list of what the hand does, instead of a mouse ---- */

typedef struct script script;
script *script_read(const char *path); /* NULL: a line was printed */
void script_free(script *s);

/* Runs the commands of one frame; mode follows them. */
void script_frame(script *s, body *b, view *v, poke_mode *mode);

/* ---- image.c ---- */

/* Writes rows from the bottom, 3 bytes a pixel, as PNG or BMP by the name's end; false: a line was printed.
 */
bool image_write(const char *path, int width, int height, const unsigned char *rgb);

#endif
