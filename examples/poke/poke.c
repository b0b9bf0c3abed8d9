/* poke.c: a window in which the mouse presses, drags and cuts a calibrated phantom, the force drawn live.
 *
 * Build with `make poke` (needs GLFW and OpenGL, libglfw3-dev and libgl-dev in Debian), then
 *   build/examples/poke/poke [MODEL.json] */
#include "poke.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double FRAME = 1.0 / 60.0; /* s */
static const char DEFAULT_MODEL[] = "data/models/phantom_11.json";
enum { WIDTH = 1280, HEIGHT = 800, SIZE_MAX_PIXELS = 16384 };

typedef struct options {
    const char *model, *script, *screenshot, *json;
    long frames; /* 0 = until the window is closed */
    int width, height;
} options;

typedef struct app {
    body body;
    view view;
    scene *scene;
    poke_mode mode;
    double x, y; /* cursor, pixels of the frame buffer */
    bool pressing;
    double start[3]; /* where the left button went down on the surface */
    double deep;     /* of the sphere or the blade's tip along the ray, m */
} app;

/* ---- the mouse ----------------------------------------------------------------------------------- */

/* Where the ray through the cursor meets the plane through start that faces the camera. */
static void follow(const app *a, double at[3], double along[3]) {
    double eye[3], right[3], up[3], ahead[3], away = 0.0, forward = 0.0;
    view_axes(&a->view, eye, right, up, ahead);
    view_ray(&a->view, a->x, a->y, eye, along);
    for (int k = 0; k < 3; k++) {
        away += (a->start[k] - eye[k]) * ahead[k];
        forward += along[k] * ahead[k];
    }
    for (int k = 0; k < 3; k++)
        at[k] = eye[k] + away / forward * along[k];
}

static double height(const app *a) {
    return a->body.high[1] - a->body.low[1];
}

static void left_down(app *a) {
    double from[3], along[3];
    body *b = &a->body;
    view_ray(&a->view, a->x, a->y, from, along);
    if (!body_hit(b, from, along, a->start))
        return;
    a->pressing = true;
    a->deep = (a->mode == POKE_CUT ? 0.4 : 0.1) * height(a);
    if (a->mode == POKE_GRASP)
        body_grasp(b, a->start, 0.13 * height(a));
    if (a->mode == POKE_PRESS) {
        for (int k = 0; k < 3; k++)
            b->sphere.position_m[k] = a->start[k] - 1.05 * b->sphere.radius_m * along[k];
        b->sphere_on = true;
    }
}

static void left_up(app *a) {
    a->pressing = a->body.sphere_on = a->body.blade_on = false;
    body_release(&a->body);
}

/* What the pressed button does in a frame. */
static void drag(app *a) {
    double at[3], along[3], edge[6];
    body *b = &a->body;
    follow(a, at, along);
    for (int k = 0; k < 3; k++) {
        if (a->mode == POKE_PRESS)
            b->sphere_goal[k] = at[k] + (a->deep - b->sphere.radius_m) * along[k];
        if (a->mode == POKE_GRASP)
            b->hand_goal[k] = at[k] - a->start[k];
        edge[k] = at[k] - 0.15 * height(a) * along[k];
        edge[3 + k] = at[k] + a->deep * along[k];
    }
    if (a->mode == POKE_CUT)
        body_slice(b, edge);
}

static void read_mouse(GLFWwindow *window, app *a) {
    double x, y, was_x = a->x, was_y = a->y;
    int width, high;
    glfwGetCursorPos(window, &x, &y);
    glfwGetWindowSize(window, &width, &high);
    a->x = x * a->view.width / (width > 0 ? width : 1);
    a->y = y * a->view.height / (high > 0 ? high : 1);
    if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT)) {
        a->view.yaw -= 0.3 * (a->x - was_x);
        a->view.pitch = fmin(89.0, fmax(-10.0, a->view.pitch + 0.3 * (a->y - was_y)));
    }
    if (a->pressing)
        drag(a);
}

static void on_button(GLFWwindow *window, int button, int action, int mods) {
    app *a = glfwGetWindowUserPointer(window);
    (void)mods;
    if (button == GLFW_MOUSE_BUTTON_LEFT)
        (action == GLFW_PRESS ? left_down : left_up)(a);
}

static void on_wheel(GLFWwindow *window, double dx, double dy) {
    app *a = glfwGetWindowUserPointer(window);
    (void)dx;
    if (a->pressing)
        a->deep = fmin(height(a), fmax(0.0, a->deep + 0.02 * dy * height(a)));
    else
        a->view.distance *= pow(0.9, dy);
}

static void on_key(GLFWwindow *window, int key, int code, int action, int mods) {
    app *a = glfwGetWindowUserPointer(window);
    (void)code;
    (void)mods;
    if (action != GLFW_PRESS)
        return;
    if (key == GLFW_KEY_ESCAPE)
        glfwSetWindowShouldClose(window, 1);
    if (key == GLFW_KEY_T)
        a->body.tearing = !a->body.tearing;
    if (key == GLFW_KEY_R || key == GLFW_KEY_P || key == GLFW_KEY_G || key == GLFW_KEY_C)
        left_up(a);
    if (key == GLFW_KEY_R)
        body_reset(&a->body);
    a->mode = key == GLFW_KEY_P   ? POKE_PRESS
              : key == GLFW_KEY_G ? POKE_GRASP
              : key == GLFW_KEY_C ? POKE_CUT
                                  : a->mode;
}

/* ---- the window ---------------------------------------------------------------------------------- */

static void on_error(int code, const char *text) {
    fprintf(stderr, "poke: GLFW: %s (%d)\n", text, code);
}

static GLFWwindow *open_window(const options *o, app *a) {
    glfwSetErrorCallback(on_error);
    if (!glfwInit())
        return NULL;
    glfwWindowHint(GLFW_SAMPLES, 4);
    glfwWindowHint(GLFW_RESIZABLE, o->script == NULL);
    GLFWwindow *window = glfwCreateWindow(o->width, o->height, "palpate: poke", NULL, NULL);
    if (!window)
        return NULL;
    glfwMakeContextCurrent(window);
    glfwSwapInterval(o->script ? 0 : 1);
    glfwSetWindowUserPointer(window, a);
    if (!o->script) {
        glfwSetMouseButtonCallback(window, on_button);
        glfwSetScrollCallback(window, on_wheel);
        glfwSetKeyCallback(window, on_key);
    }
    return window;
}

static bool save_picture(const options *o, const view *v) {
    unsigned char *rgb = malloc(3 * (size_t)v->width * (size_t)v->height);
    if (!rgb)
        return false;
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, v->width, v->height, GL_RGB, GL_UNSIGNED_BYTE, rgb);
    bool ok = image_write(o->screenshot, v->width, v->height, rgb);
    free(rgb);
    return ok;
}

static const char *base_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static bool run(GLFWwindow *window, app *a, script *s, const options *o) {
    bool ok = true;
    for (long frame = 1; !glfwWindowShouldClose(window); frame++) {
        glfwPollEvents();
        glfwGetFramebufferSize(window, &a->view.width, &a->view.height);
        if (a->view.width < 1 || a->view.height < 1) /* minimized */
            continue;
        if (s)
            script_frame(s, &a->body, &a->view, &a->mode);
        else
            read_mouse(window, a);
        body_step(&a->body, FRAME, s == NULL);
        scene_draw(a->scene, &a->body, &a->view);
        panel_draw(&a->body, &a->view, a->mode, base_name(o->model));
        bool last = frame == o->frames;
        if (last && o->screenshot)
            ok = save_picture(o, &a->view);
        glfwSwapBuffers(window);
        if (last)
            break;
    }
    return ok;
}

static void report(const body *b) {
    printf("%.3f s, force %.6f %.6f %.6f N, %zu cut, %zu torn, %zu loose, %zu ticks failed\n", b->time,
           b->force_N[0], b->force_N[1], b->force_N[2], b->n_cut, b->n_torn, palp_network_loose(b->net, NULL),
           b->failed);
}

/* The figures of the last frame, as the panel shows them. */
static bool save_figures(const char *path, const body *b) {
    palp_error error = {PALP_OK, ""};
    palp_file file;
    palp_status status = palp_file_begin(&file, path, &error);
    if (!status) {
        fprintf(file.stream, "{\"nodes\": %zu, \"force_N\": %.3f, \"tick_ms\": %.2f}\n",
                palp_mesh_node_count(b->mesh), b->curve_N[(b->curve_end - 1) % POKE_CURVE],
                1e3 * body_tick_median(b));
        status = palp_file_commit(&file, false, &error);
    }
    if (status)
        fprintf(stderr, "poke: %s\n", error.text);
    return status == PALP_OK;
}

/* ---- the command line ---------------------------------------------------------------------------- */

static void usage(FILE *to) {
    fprintf(to,
            "Usage: poke [MODEL.json] [options]\n\n"
            "Presses, drags and cuts a network model with the mouse, its force drawn live.\n"
            "Without MODEL.json: %s\n\n"
            "  --script FILE      what to do instead of the mouse (examples/poke/script.c says how)\n"
            "  --frames N         end after so many frames (60 a second of the model's time)\n"
            "  --screenshot FILE  the last of them as FILE.png or FILE.ppm\n"
            "  --json FILE        the figures that the panel shows at the end\n"
            "  --size WxH         of the window, pixels (default %dx%d)\n"
            "  --help             this text\n",
            DEFAULT_MODEL, WIDTH, HEIGHT);
}

static bool read_size(const char *text, options *o) {
    char rest;
    return sscanf(text, "%dx%d%c", &o->width, &o->height, &rest) == 2 && o->width >= 64 && o->height >= 64 &&
           o->width <= SIZE_MAX_PIXELS && o->height <= SIZE_MAX_PIXELS;
}

static bool read_option(const char *name, const char *value, options *o) {
    char *end;
    if (strcmp(name, "--script") == 0) {
        o->script = value;
    } else if (strcmp(name, "--screenshot") == 0) {
        o->screenshot = value;
    } else if (strcmp(name, "--json") == 0) {
        o->json = value;
    } else if (strcmp(name, "--frames") == 0) {
        o->frames = strtol(value, &end, 10);
        return *value && !*end && o->frames >= 1;
    } else if (strcmp(name, "--size") == 0) {
        return read_size(value, o);
    } else {
        return false;
    }
    return true;
}

static bool read_options(int n, char **arguments, options *o) {
    for (int i = 1; i < n; i++) {
        if (arguments[i][0] != '-') {
            o->model = arguments[i];
        } else if (i + 1 == n || !read_option(arguments[i], arguments[i + 1], o)) {
            fprintf(stderr, "poke: %s: no such option, or its value is missing or wrong; see poke --help\n",
                    arguments[i]);
            return false;
        } else {
            i++;
        }
    }
    if (o->screenshot && o->frames == 0) {
        fprintf(stderr, "poke: --screenshot wants --frames\n");
        return false;
    }
    return true;
}

static void place_camera(app *a) {
    const body *b = &a->body;
    double size = 0.0;
    a->view.yaw = 32.0;
    a->view.pitch = 27.0;
    for (int k = 0; k < 3; k++) {
        a->view.centre[k] = 0.5 * (b->low[k] + b->high[k]);
        size = fmax(size, b->high[k] - b->low[k]);
    }
    a->view.distance = 5.0 * size;
}

int main(int n, char **arguments) {
    static app a;
    options o = {.model = DEFAULT_MODEL, .width = WIDTH, .height = HEIGHT};
    if (n == 2 && strcmp(arguments[1], "--help") == 0) {
        usage(stdout);
        return 0;
    }
    if (!read_options(n, arguments, &o))
        return 2;
    script *s = o.script ? script_read(o.script) : NULL;
    if ((o.script && !s) || !body_open(&a.body, o.model)) {
        script_free(s);
        return 1;
    }
    place_camera(&a);
    a.scene = scene_create(&a.body);
    GLFWwindow *window = a.scene ? open_window(&o, &a) : NULL;
    bool ok = window && run(window, &a, s, &o);
    if (ok)
        report(&a.body);
    ok = ok && (!o.json || a.body.curve_end == 0 || save_figures(o.json, &a.body));
    glfwTerminate();
    scene_free(a.scene);
    script_free(s);
    body_close(&a.body);
    return ok ? 0 : 1;
}
