/* view.c: the camera, and the scene in OpenGL's fixed pipeline: the phantom, its plate, what touches it. */
#include "poke.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

static const double HALF_ANGLE = 15.0 * PI / 180.0; /* of the picture's height */
static const double CREASE = 0.6;      /* cosine: faces at a larger angle keep an edge between them */
static const double FULL_STRAIN = 0.4; /* of the last colour */
static const double GRID = 0.01;

struct scene {
    size_t n_nodes, n_original, room;
    int32_t *original;          /* [3 n_original] triangles of the uncut surface, each and all sorted */
    size_t *first;              /* [n_nodes + 2] of each node, in around */
    int32_t *around;            /* [3 room] triangles at each node */
    double *face;               /* [3 room] their normals, as long as twice the area */
    double *strain;             /* [n_nodes] mean over the elements */
    int *count;                 /* [n_nodes] */
    float *x, *normal, *colour; /* [9 room] by corners */
};

/* ---- camera -------------------------------------------------------------------------------------- */

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void unit(double v[3]) {
    double length = sqrt(dot(v, v));
    for (int k = 0; k < 3; k++)
        v[k] = length > 0.0 ? v[k] / length : 0.0;
}

void view_axes(const view *v, double eye[3], double right[3], double up[3], double ahead[3]) {
    double yaw = v->yaw * PI / 180.0, pitch = v->pitch * PI / 180.0, y[3] = {0.0, 1.0, 0.0};
    ahead[0] = -sin(yaw) * cos(pitch);
    ahead[1] = -sin(pitch);
    ahead[2] = -cos(yaw) * cos(pitch);
    cross(ahead, y, right);
    unit(right);
    cross(right, ahead, up);
    for (int k = 0; k < 3; k++)
        eye[k] = v->centre[k] - v->distance * ahead[k];
}

void view_ray(const view *v, double x, double y, double from[3], double along[3]) {
    double right[3], up[3], ahead[3], half = tan(HALF_ANGLE);
    view_axes(v, from, right, up, ahead);
    double sx = (2.0 * x - v->width) / v->height * half, sy = (v->height - 2.0 * y) / v->height * half;
    for (int k = 0; k < 3; k++)
        along[k] = ahead[k] + sx * right[k] + sy * up[k];
    unit(along);
}

double view_pixel(const view *v, const double at[3]) {
    double eye[3], right[3], up[3], ahead[3], to[3];
    view_axes(v, eye, right, up, ahead);
    for (int k = 0; k < 3; k++)
        to[k] = at[k] - eye[k];
    return 2.0 * dot(to, ahead) * tan(HALF_ANGLE) / v->height;
}

static void set_camera(const view *v) {
    double eye[3], right[3], up[3], ahead[3], m[16] = {0.0};
    double near = 0.05 * v->distance, top = near * tan(HALF_ANGLE), side = top * v->width / v->height;
    view_axes(v, eye, right, up, ahead);
    glMatrixMode(GL_PROJECTION);
    glLoadIdentity();
    glFrustum(-side, side, -top, top, near, 20.0 * v->distance);
    glMatrixMode(GL_MODELVIEW);
    for (int k = 0; k < 3; k++) {
        m[4 * k] = right[k];
        m[4 * k + 1] = up[k];
        m[4 * k + 2] = -ahead[k];
    }
    m[12] = -dot(right, eye);
    m[13] = -dot(up, eye);
    m[14] = dot(ahead, eye);
    m[15] = 1.0;
    glLoadMatrixd(m);
}

/* ---- the phantom's surface ----------------------------------------------------------------------- */

static int compare_triangles(const void *left, const void *right) {
    const int32_t *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k])
            return a[k] < b[k] ? -1 : 1;
    return 0;
}

static void sort_corners(const int32_t *from, int32_t to[3]) {
    memcpy(to, from, 3 * sizeof *to);
    for (int i = 1; i < 3; i++)
        for (int j = i; j > 0 && to[j] < to[j - 1]; j--) {
            int32_t swap = to[j];
            to[j] = to[j - 1];
            to[j - 1] = swap;
        }
}

scene *scene_create(const body *b) {
    scene *s = calloc(1, sizeof *s);
    if (!s)
        return NULL;
    s->n_nodes = palp_mesh_node_count(b->mesh);
    s->n_original = palp_mesh_triangle_count(b->mesh);
    s->room = 4 * palp_mesh_tetrahedron_count(b->mesh);
    s->original = malloc((3 * s->n_original + 1) * sizeof *s->original);
    s->first = malloc((s->n_nodes + 2) * sizeof *s->first);
    s->around = malloc((3 * s->room + 1) * sizeof *s->around);
    s->face = malloc((3 * s->room + 1) * sizeof *s->face);
    s->strain = malloc(s->n_nodes * sizeof *s->strain);
    s->count = malloc(s->n_nodes * sizeof *s->count);
    s->x = malloc((9 * s->room + 1) * sizeof *s->x);
    s->normal = malloc((9 * s->room + 1) * sizeof *s->normal);
    s->colour = malloc((9 * s->room + 1) * sizeof *s->colour);
    if (!s->original || !s->first || !s->around || !s->face || !s->strain || !s->count || !s->x ||
        !s->normal || !s->colour) {
        scene_free(s);
        return NULL;
    }
    for (size_t i = 0; i < s->n_original; i++)
        sort_corners(palp_mesh_triangles(b->mesh) + 3 * i, s->original + 3 * i);
    qsort(s->original, s->n_original, 3 * sizeof *s->original, compare_triangles);
    return s;
}

void scene_free(scene *s) {
    if (!s)
        return;
    free(s->original);
    free(s->first);
    free(s->around);
    free(s->face);
    free(s->strain);
    free(s->count);
    free(s->x);
    free(s->normal);
    free(s->colour);
    free(s);
}

double scene_colour(double strain, double rgb[3]) {
    static const double stops[4][3] = {
        {0.93, 0.72, 0.62}, {0.96, 0.60, 0.32}, {0.85, 0.22, 0.17}, {0.42, 0.05, 0.25}};
    double at = fmin(fmax(strain / FULL_STRAIN, 0.0), 1.0) * 3.0, share = at - floor(fmin(at, 2.0));
    int i = (int)fmin(at, 2.0);
    for (int k = 0; k < 3; k++)
        rgb[k] = (1.0 - share) * stops[i][k] + share * stops[i + 1][k];
    return FULL_STRAIN;
}

/* Mean |strain| of the whole elements at each node. */
static void find_strain(scene *s, const body *b) {
    const int32_t *pairs = palp_mesh_pairs(b->mesh);
    const double *e = palp_network_element_strain(b->net);
    const unsigned char *alive = palp_network_alive(b->net);
    memset(s->strain, 0, s->n_nodes * sizeof *s->strain);
    memset(s->count, 0, s->n_nodes * sizeof *s->count);
    for (size_t i = 0; i < 2 * palp_mesh_element_count(b->mesh); i++)
        if (alive[i / 2]) {
            s->strain[pairs[i]] += fabs(e[i / 2]);
            s->count[pairs[i]]++;
        }
    for (size_t i = 0; i < s->n_nodes; i++)
        s->strain[i] /= s->count[i] > 0 ? s->count[i] : 1;
}

/* Normals of the triangles, and which of them meet in each node. */
static void find_faces(scene *s, const double *x, size_t n, const int32_t *t) {
    memset(s->first, 0, (s->n_nodes + 2) * sizeof *s->first);
    for (size_t i = 0; i < n; i++) {
        double u[3], v[3];
        for (int k = 0; k < 3; k++) {
            s->first[t[3 * i + (size_t)k] + 2]++;
            u[k] = x[3 * t[3 * i + 1] + k] - x[3 * t[3 * i] + k];
            v[k] = x[3 * t[3 * i + 2] + k] - x[3 * t[3 * i] + k];
        }
        cross(u, v, s->face + 3 * i);
    }
    for (size_t i = 2; i < s->n_nodes + 2; i++)
        s->first[i] += s->first[i - 1];
    for (size_t i = 0; i < 3 * n; i++)
        s->around[s->first[t[i] + 1]++] = (int32_t)(i / 3);
}

/* Mean normal of the triangles at a node that are nearly in the plane of this one. */
static void corner_normal(const scene *s, size_t triangle, int32_t node, float out[3]) {
    const double *own = s->face + 3 * triangle;
    double sum[3] = {0.0};
    for (size_t j = s->first[node]; j < s->first[node + 1]; j++) {
        const double *other = s->face + 3 * s->around[j];
        if (dot(own, other) > CREASE * sqrt(dot(own, own) * dot(other, other)))
            for (int k = 0; k < 3; k++)
                sum[k] += other[k];
    }
    unit(sum);
    for (int k = 0; k < 3; k++)
        out[k] = (float)sum[k];
}

static void fill_surface(scene *s, const body *b, size_t n, const int32_t *t) {
    const double *x = palp_network_positions(b->net);
    find_strain(s, b);
    find_faces(s, x, n, t);
    for (size_t i = 0; i < n; i++) {
        int32_t key[3];
        sort_corners(t + 3 * i, key);
        bool inside = !bsearch(key, s->original, s->n_original, sizeof key, compare_triangles);
        for (size_t c = 0; c < 3; c++) {
            int32_t node = t[3 * i + c];
            double rgb[3];
            static const double flesh[3] = {0.66, 0.16, 0.18};
            scene_colour(s->strain[node], rgb);
            corner_normal(s, i, node, s->normal + 9 * i + 3 * c);
            for (size_t k = 0; k < 3; k++) {
                s->x[9 * i + 3 * c + k] = (float)x[3 * (size_t)node + k];
                s->colour[9 * i + 3 * c + k] = (float)(inside ? 0.25 * rgb[k] + 0.75 * flesh[k] : rgb[k]);
            }
        }
    }
}

static void shine(float size, float sharp) {
    const float specular[4] = {size, size, size, 1.0f};
    glMaterialfv(GL_FRONT_AND_BACK, GL_SPECULAR, specular);
    glMaterialf(GL_FRONT_AND_BACK, GL_SHININESS, sharp);
}

static void draw_body(scene *s, const body *b) {
    const int32_t *t;
    size_t n;
    palp_network_surface(b->net, &n, &t);
    fill_surface(s, b, n, t);
    shine(0.22f, 24.0f);
    glEnableClientState(GL_VERTEX_ARRAY);
    glEnableClientState(GL_NORMAL_ARRAY);
    glEnableClientState(GL_COLOR_ARRAY);
    glVertexPointer(3, GL_FLOAT, 0, s->x);
    glNormalPointer(GL_FLOAT, 0, s->normal);
    glColorPointer(3, GL_FLOAT, 0, s->colour);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1.0f, 1.0f);
    glDrawArrays(GL_TRIANGLES, 0, (GLsizei)(3 * n));
    glDisable(GL_POLYGON_OFFSET_FILL);
    glDisableClientState(GL_COLOR_ARRAY);
    glDisable(GL_LIGHTING); /* the triangles' edges, faintly */
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glColor4d(0.15, 0.02, 0.02, 0.13);
    glLineWidth(1.0f);
    glDrawArrays(GL_TRIANGLES, 0, (GLsizei)(3 * n));
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glEnable(GL_LIGHTING);
    glDisableClientState(GL_VERTEX_ARRAY);
    glDisableClientState(GL_NORMAL_ARRAY);
}

/* ---- tools --------------------------------------------------------------------------------------- */

static void draw_sphere(const double at[3], double radius) {
    enum { RINGS = 24, PARTS = 36 };
    for (int i = 0; i < RINGS; i++) {
        glBegin(GL_QUAD_STRIP);
        for (int j = 0; j <= PARTS; j++)
            for (int k = 1; k >= 0; k--) {
                double down = PI * (i + k) / RINGS, round = 2.0 * PI * j / PARTS;
                double n[3] = {sin(down) * cos(round), cos(down), sin(down) * sin(round)};
                glNormal3dv(n);
                glVertex3d(at[0] + radius * n[0], at[1] + radius * n[1], at[2] + radius * n[2]);
            }
        glEnd();
    }
}

/* A rod of a length from a point, thick at its start and its end. */
static void draw_rod(const double from[3], const double along[3], double length, double thick,
                     double thick_end) {
    enum { PARTS = 24 };
    double a[3] = {along[0], along[1], along[2]}, u[3], v[3], other[3] = {1.0, 0.0, 0.0};
    unit(a);
    if (fabs(a[0]) > 0.9) {
        other[0] = 0.0;
        other[2] = 1.0;
    }
    cross(a, other, u);
    unit(u);
    cross(a, u, v);
    glBegin(GL_QUAD_STRIP);
    for (int j = 0; j <= PARTS; j++) {
        double c = cos(2.0 * PI * j / PARTS), s = sin(2.0 * PI * j / PARTS), n[3], p[3], q[3];
        for (int k = 0; k < 3; k++) {
            n[k] = c * u[k] + s * v[k];
            p[k] = from[k] + thick * n[k];
            q[k] = from[k] + length * a[k] + thick_end * n[k];
        }
        glNormal3dv(n);
        glVertex3dv(p);
        glVertex3dv(q);
    }
    glEnd();
}

static void draw_blade(const body *b) {
    const double *tip = b->blade + 3, *top = b->blade;
    double along[3] = {top[0] - tip[0], top[1] - tip[1], top[2] - tip[2]}, length = sqrt(dot(along, along));
    shine(0.9f, 80.0f);
    glColor3d(0.80, 0.83, 0.88);
    draw_rod(tip, along, length, 2e-5, 6e-4);
    glColor3d(0.25, 0.28, 0.33);
    draw_rod(top, along, 0.08, 8e-4, 1.6e-3);
}

static void draw_hand(const body *b) {
    const double *x = palp_network_positions(b->net), up[3] = {0.35, 1.0, 0.3};
    double middle[3] = {0.0};
    shine(0.6f, 40.0f);
    glColor3d(0.30, 0.55, 0.80);
    for (size_t i = 0; i < b->n_grasped; i++) {
        draw_sphere(x + 3 * b->grasped[i], 5e-4);
        for (int k = 0; k < 3; k++)
            middle[k] += (b->grasped_from[3 * i + (size_t)k] + b->hand[k]) / (double)b->n_grasped;
    }
    glColor3d(0.70, 0.73, 0.78);
    draw_rod(middle, up, 0.08, 7e-4, 2.2e-3);
}

static void draw_tools(const body *b) {
    const double up[3] = {0.28, 1.0, 0.18};
    if (b->sphere_on) {
        shine(0.9f, 70.0f);
        glColor3d(0.62, 0.66, 0.72);
        draw_sphere(b->sphere.position_m, b->sphere.radius_m);
        glColor3d(0.33, 0.36, 0.42);
        draw_rod(b->sphere.position_m, up, 0.12, 0.35 * b->sphere.radius_m, 0.35 * b->sphere.radius_m);
    }
    if (b->n_grasped > 0)
        draw_hand(b);
    if (b->blade_on)
        draw_blade(b);
}

/* ---- all of it ----------------------------------------------------------------------------------- */

static void draw_background(void) {
    glMatrixMode(GL_PROJECTION);
    glLoadIdentity();
    glMatrixMode(GL_MODELVIEW);
    glLoadIdentity();
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_LIGHTING);
    glBegin(GL_QUADS);
    glColor3d(0.10, 0.12, 0.16);
    glVertex2d(-1.0, -1.0);
    glVertex2d(1.0, -1.0);
    glColor3d(0.32, 0.37, 0.44);
    glVertex2d(1.0, 1.0);
    glVertex2d(-1.0, 1.0);
    glEnd();
    glEnable(GL_DEPTH_TEST);
}

/* The plate with lines every 10 mm, fading outwards, and a shade under the phantom. */
static void draw_plate(const body *b) {
    enum { LINES = 6, PARTS = 48 };
    double x = 0.5 * (b->low[0] + b->high[0]), z = 0.5 * (b->low[2] + b->high[2]), y = b->low[1],
           reach = LINES * GRID;
    double shade = 0.85 * fmax(b->high[0] - b->low[0], b->high[2] - b->low[2]);
    glDisable(GL_LIGHTING);
    glBegin(GL_TRIANGLE_FAN);
    glColor4d(0.55, 0.59, 0.64, 1.0);
    glVertex3d(x, y - 1e-4, z);
    glColor4d(0.35, 0.39, 0.45, 0.0);
    for (int j = 0; j <= PARTS; j++)
        glVertex3d(x + 1.6 * reach * cos(2.0 * PI * j / PARTS), y - 1e-4,
                   z + 1.6 * reach * sin(2.0 * PI * j / PARTS));
    glEnd();
    glBegin(GL_TRIANGLE_FAN);
    glColor4d(0.05, 0.06, 0.08, 0.75);
    glVertex3d(x, y - 5e-5, z);
    glColor4d(0.05, 0.06, 0.08, 0.0);
    for (int j = 0; j <= PARTS; j++)
        glVertex3d(x + shade * cos(2.0 * PI * j / PARTS), y - 5e-5, z + shade * sin(2.0 * PI * j / PARTS));
    glEnd();
    glLineWidth(1.0f);
    glBegin(GL_LINES);
    for (int i = -LINES; i <= LINES; i++)
        for (int half = -1; half <= 1; half += 2) {
            double fade = 0.35 * (1.0 - fabs((double)i) / (LINES + 1));
            glColor4d(0.95, 0.97, 1.0, fade);
            glVertex3d(x + i * GRID, y, z);
            glColor4d(0.95, 0.97, 1.0, 0.0);
            glVertex3d(x + i * GRID, y, z + half * reach);
            glColor4d(0.95, 0.97, 1.0, fade);
            glVertex3d(x, y, z + i * GRID);
            glColor4d(0.95, 0.97, 1.0, 0.0);
            glVertex3d(x + half * reach, y, z + i * GRID);
        }
    glEnd();
    glEnable(GL_LIGHTING);
}

static void set_lights(void) {
    const float key[4] = {0.45f, 0.9f, 0.6f, 0.0f}, fill[4] = {-0.7f, 0.25f, 0.35f, 0.0f};
    const float bright[4] = {0.66f, 0.64f, 0.61f, 1.0f}, dim[4] = {0.34f, 0.36f, 0.42f, 1.0f},
                none[4] = {0, 0, 0, 1};
    const float white[4] = {1.0f, 1.0f, 1.0f, 1.0f}, ambient[4] = {0.34f, 0.34f, 0.36f, 1.0f};
    glPushMatrix();
    glLoadIdentity(); /* they go with the camera */
    glLightfv(GL_LIGHT0, GL_POSITION, key);
    glLightfv(GL_LIGHT1, GL_POSITION, fill);
    glPopMatrix();
    glLightfv(GL_LIGHT0, GL_DIFFUSE, bright);
    glLightfv(GL_LIGHT0, GL_SPECULAR, white);
    glLightfv(GL_LIGHT1, GL_DIFFUSE, dim);
    glLightfv(GL_LIGHT1, GL_SPECULAR, none);
    glLightModelfv(GL_LIGHT_MODEL_AMBIENT, ambient);
    glLightModeli(GL_LIGHT_MODEL_TWO_SIDE, 1);
    glEnable(GL_LIGHTING);
    glEnable(GL_LIGHT0);
    glEnable(GL_LIGHT1);
    glEnable(GL_COLOR_MATERIAL);
    glColorMaterial(GL_FRONT_AND_BACK, GL_AMBIENT_AND_DIFFUSE);
    glEnable(GL_NORMALIZE);
}

void scene_draw(scene *s, const body *b, const view *v) {
    glViewport(0, 0, v->width, v->height);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    draw_background();
    set_camera(v);
    set_lights();
    draw_plate(b);
    draw_body(s, b);
    draw_tools(b);
}
