/* panel.c: text, the force over time, the colours' scale and the keys, drawn over the scene. */
#include "poke.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <stb_easy_font.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const double FRAME = 1.0 / 60.0; /* between two values of the curve, s */
enum { MARGIN = 18, LINE = 18, CURVE_WIDTH = 380, CURVE_HEIGHT = 120, TEXT_MAX = 128 };

static void rectangle(double x, double y, double width, double height) {
    glBegin(GL_QUADS);
    glVertex2d(x, y);
    glVertex2d(x + width, y);
    glVertex2d(x + width, y + height);
    glVertex2d(x, y + height);
    glEnd();
}

enum { LEFT, RIGHT };
static const double SMALL = 1.6,
                    LARGE = 3.2; /* sizes of text: 7 of these pixels are the height of a capital */

/* Text of a size whose upper left, or right, corner is at x, y. */
static void text(double x, double y, double size, int side, const char *format, ...) {
    static float corners[TEXT_MAX * 80]; /* stb: some 270 bytes a character */
    char line[TEXT_MAX];
    va_list list;
    va_start(list, format);
    vsnprintf(line, sizeof line, format, list);
    va_end(list);
    int quads = stb_easy_font_print(0.0f, 0.0f, line, NULL, corners, sizeof corners);
    glPushMatrix();
    glTranslated(side == RIGHT ? x - size * stb_easy_font_width(line) : x, y, 0.0);
    glScaled(size, size, 1.0);
    glEnableClientState(GL_VERTEX_ARRAY);
    glVertexPointer(2, GL_FLOAT, 16, corners);
    glDrawArrays(GL_QUADS, 0, 4 * quads);
    glDisableClientState(GL_VERTEX_ARRAY);
    glPopMatrix();
}

static void card(double x, double y, double width, double height) {
    glColor4d(0.06, 0.07, 0.10, 0.62);
    rectangle(x, y, width, height);
}

static void bright(void) {
    glColor4d(0.94, 0.96, 0.98, 1.0);
}

static void dim(void) {
    glColor4d(0.76, 0.80, 0.85, 1.0);
}

/* ---- force --------------------------------------------------------------------------------------- */

/* The smallest of 1, 2, 5 times a power of ten that is not below the value. */
static double round_up(double value) {
    double unit = pow(10.0, floor(log10(value)));
    return value <= unit         ? unit
           : value <= 2.0 * unit ? 2.0 * unit
           : value <= 5.0 * unit ? 5.0 * unit
                                 : 10.0 * unit;
}

static double curve_top(const body *b) {
    double top = 0.05;
    for (int i = 0; i < POKE_CURVE; i++)
        top = fmax(top, b->curve_N[i]);
    return round_up(1.02 * top);
}

static void draw_axes(double x, double y, double top) {
    const double seconds = POKE_CURVE * FRAME;
    glLineWidth(1.0f);
    for (int i = 0; i <= 4; i++) {
        double at = y + CURVE_HEIGHT * (1.0 - i / 4.0);
        glColor4d(1.0, 1.0, 1.0, i == 0 ? 0.45 : 0.13);
        rectangle(x, at, CURVE_WIDTH, 1.0);
        dim();
        if (i % 2 == 0)
            text(x - 6, at - 6, SMALL, RIGHT, "%.3g", top * i / 4.0);
    }
    for (int i = 0; i <= 5; i++) {
        double at = x + CURVE_WIDTH * i / 5.0;
        glColor4d(1.0, 1.0, 1.0, i == 0 ? 0.45 : 0.13);
        rectangle(at, y, 1.0, CURVE_HEIGHT);
        dim();
        text(at + 8, y + CURVE_HEIGHT + 9, SMALL, RIGHT, "%.0f", seconds * (i / 5.0 - 1.0));
    }
    text(x - 46, y - 24, SMALL, LEFT, "force, N");
    text(x + CURVE_WIDTH + 8, y + CURVE_HEIGHT + 26, SMALL, RIGHT, "time, s");
}

static void draw_curve(const body *b, double x, double y, double top) {
    size_t n = b->curve_end < POKE_CURVE ? b->curve_end : POKE_CURVE;
    for (int fill = 1; fill >= 0; fill--) {
        glColor4d(0.99, 0.72, 0.30, fill ? 0.20 : 1.0);
        glLineWidth(2.0f);
        glBegin(fill ? GL_QUAD_STRIP : GL_LINE_STRIP);
        for (size_t i = 0; i < n; i++) {
            double force = b->curve_N[(b->curve_end - n + i) % POKE_CURVE];
            double at = x + CURVE_WIDTH * (double)(POKE_CURVE - n + i) / (POKE_CURVE - 1);
            glVertex2d(at, y + CURVE_HEIGHT * (1.0 - force / top));
            if (fill)
                glVertex2d(at, y + CURVE_HEIGHT);
        }
        glEnd();
    }
}

static void draw_force(const body *b, const view *v) {
    double x = v->width - MARGIN - CURVE_WIDTH - 16, y = v->height - MARGIN - CURVE_HEIGHT - 46,
           top = curve_top(b);
    double now = b->curve_end > 0 ? b->curve_N[(b->curve_end - 1) % POKE_CURVE] : 0.0;
    card(x - 58, y - 44, CURVE_WIDTH + 74, CURVE_HEIGHT + 90);
    draw_axes(x, y, top);
    draw_curve(b, x, y, top);
    glColor4d(0.99, 0.72, 0.30, 1.0);
    text(x + CURVE_WIDTH, y - 36, LARGE, RIGHT, "%.3f N", now);
}

/* ---- what it is, and the keys -------------------------------------------------------------------- */

static void draw_state(const body *b, poke_mode mode, const char *name) {
    static const char *const modes[] = {"press", "grasp", "cut"};
    static const char *const labels[] = {"model", "network", "whole", "loose", "force", "tick", "touches"};
    const int lines = b->n_regions > 0 ? 7 : 6;
    const double y = MARGIN, left = MARGIN + 14, at = left + 90;
    size_t n = palp_mesh_element_count(b->mesh), lost = b->n_cut + b->n_torn;
    card(MARGIN, y, 392, (2 + lines) * LINE + 22);
    bright();
    text(left, y + 10, LARGE, LEFT, "%s", modes[mode]);
    dim();
    for (int i = 0; i < lines; i++)
        text(left, y + (2.6 + i) * LINE, SMALL, LEFT, "%s", labels[i]);
    text(at, y + 2.6 * LINE, SMALL, LEFT, "%.36s", name);
    text(at, y + 3.6 * LINE, SMALL, LEFT, "%zu nodes, %zu elements", palp_mesh_node_count(b->mesh), n);
    text(at, y + 4.6 * LINE, SMALL, LEFT, "%zu, cut %zu, torn %zu", n - lost, b->n_cut, b->n_torn);
    text(at, y + 5.6 * LINE, SMALL, LEFT, "%zu nodes", palp_network_loose(b->net, NULL));
    text(at, y + 6.6 * LINE, SMALL, LEFT, "(%.3f, %.3f, %.3f) N", b->force_N[0], b->force_N[1],
         b->force_N[2]);
    text(at, y + 7.6 * LINE, SMALL, LEFT, "%.2f ms, median of 1 s", 1e3 * body_tick_median(b));
    if (b->n_regions > 0)
        text(at, y + 8.6 * LINE, SMALL, LEFT, "%.36s",
             b->touched >= 0 ? b->region[b->touched]
             : b->sphere_on  ? "the tissue around"
                             : "nothing");
}

static void draw_keys(const body *b, const view *v) {
    const char *const lines[] = {
        "P press   G grasp   C cut   with the left button", "wheel while pressing: deeper; else nearer",
        "right button: turn    R: whole again",
        b->tearing ? "T: tearing is on      Esc: quit" : "T: tearing is off     Esc: quit"};
    const double y = v->height - MARGIN - 4 * LINE - 12;
    card(MARGIN, y, 466, 4 * LINE + 12);
    dim();
    for (int i = 0; i < 4; i++)
        text(MARGIN + 14, y + 8 + i * LINE, SMALL, LEFT, "%s", lines[i]);
}

static void draw_scale(const view *v) {
    enum { STEPS = 80 };
    const double width = 240, x = v->width - MARGIN - width - 16, y = MARGIN + 34;
    double rgb[3], full = scene_colour(0.0, rgb);
    card(x - 14, MARGIN, width + 30, 84);
    dim();
    text(x, MARGIN + 10, SMALL, LEFT, "mean strain of elements, %%");
    for (int i = 0; i < STEPS; i++) {
        scene_colour(full * (i + 0.5) / STEPS, rgb);
        glColor3dv(rgb);
        rectangle(x + width * i / STEPS, y, width / STEPS + 0.5, 16);
    }
    dim();
    for (int i = 0; i <= 2; i++)
        text(x + 0.5 * width * i + (i == 0 ? 8 : 0), y + 22, SMALL, RIGHT, "%.0f", 50.0 * full * i);
}

void panel_draw(const body *b, const view *v, poke_mode mode, const char *name) {
    glMatrixMode(GL_PROJECTION);
    glLoadIdentity();
    glOrtho(0.0, v->width, v->height, 0.0, -1.0, 1.0);
    glMatrixMode(GL_MODELVIEW);
    glLoadIdentity();
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_LIGHTING);
    draw_state(b, mode, name);
    draw_keys(b, v);
    draw_scale(v);
    draw_force(b, v);
    glEnable(GL_DEPTH_TEST);
}
