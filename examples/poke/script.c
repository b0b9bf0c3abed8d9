/* script.c: what the hand does, from a file: one command a line, lengths in mm, # starts a comment.
 *
 *   press X Y Z FRAMES       the sphere's centre goes there within so many frames (at once if it was away)
 *   lift                     takes the sphere away
 *   grasp X Y Z RADIUS       grasps the surface within the radius
 *   drag DX DY DZ FRAMES     moves the hand by that much
 *   release
 *   blade X Y Z X Y Z        places the blade's edge
 *   slice DX DY DZ FRAMES    moves it by that much, cutting
 *   sheathe                  takes the blade away
 *   turn YAW PITCH FRAMES    turns the camera by degrees
 *   tear 0|1                 whether overstretched elements tear
 *   wait FRAMES */
#include "poke.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VALUES = 6 };

typedef enum action {
    PRESS,
    LIFT,
    GRASP,
    DRAG,
    RELEASE,
    BLADE,
    SLICE,
    SHEATHE,
    TURN,
    TEAR,
    WAIT,
    ACTIONS
} action;

/* Name, number of values, which of them counts frames (-1: none). */
static const struct {
    const char *name;
    int values, frames;
} table[ACTIONS] = {{"press", 4, 3},    {"lift", 0, -1},  {"grasp", 4, -1}, {"drag", 4, 3},
                    {"release", 0, -1}, {"blade", 6, -1}, {"slice", 4, 3},  {"sheathe", 0, -1},
                    {"turn", 3, 2},     {"tear", 1, -1},  {"wait", 1, 0}};

typedef struct command {
    action what;
    double value[VALUES];
} command;

struct script {
    size_t n, next;
    int left; /* frames of the command before next that are still to come */
    command *commands;
};

static bool read_line(const char *path, size_t number, char *line, command *c) {
    char *word = strtok(line, " \t\r\n"), *end;
    c->what = 0;
    while (c->what < ACTIONS && strcmp(table[c->what].name, word) != 0)
        c->what++;
    if (c->what == ACTIONS) {
        fprintf(stderr, "poke: %s:%zu: unknown command '%s'\n", path, number, word);
        return false;
    }
    for (int i = 0; i < table[c->what].values; i++) {
        bool frames = i == table[c->what].frames;
        word = strtok(NULL, " \t\r\n");
        c->value[i] = word ? strtod(word, &end) : 0.0;
        if (!word || *end || !isfinite(c->value[i]) ||
            (frames && !(c->value[i] >= 1.0 && c->value[i] <= 1e6))) {
            fprintf(stderr, "poke: %s:%zu: '%s' wants %d numbers%s\n", path, number, table[c->what].name,
                    table[c->what].values, frames ? ", the last one frames, from 1" : "");
            return false;
        }
    }
    if (strtok(NULL, " \t\r\n")) {
        fprintf(stderr, "poke: %s:%zu: '%s' has too many values\n", path, number, table[c->what].name);
        return false;
    }
    return true;
}

static bool read_all(FILE *file, const char *path, script *s) {
    char line[256];
    for (size_t number = 1; fgets(line, sizeof line, file); number++) {
        line[strcspn(line, "#")] = '\0';
        if (line[strspn(line, " \t\r\n")] == '\0')
            continue;
        command *grown = realloc(s->commands, (s->n + 1) * sizeof *grown);
        if (!grown)
            return false;
        s->commands = grown;
        if (!read_line(path, number, line, &s->commands[s->n++]))
            return false;
    }
    return !ferror(file);
}

script *script_read(const char *path) {
    script *s = calloc(1, sizeof *s);
    FILE *file = fopen(path, "r");
    if (!file)
        fprintf(stderr, "poke: %s: cannot be read\n", path);
    bool ok = s && file && read_all(file, path, s);
    if (file)
        fclose(file);
    if (!ok) {
        script_free(s);
        return NULL;
    }
    return s;
}

void script_free(script *s) {
    if (s)
        free(s->commands);
    free(s);
}

static void start(const command *c, body *b, poke_mode *mode) {
    double mm[VALUES];
    for (int i = 0; i < VALUES; i++)
        mm[i] = 1e-3 * c->value[i];
    if (c->what == PRESS) {
        *mode = POKE_PRESS;
        if (!b->sphere_on)
            memcpy(b->sphere.position_m, mm, 3 * sizeof *mm);
        memcpy(b->sphere_goal, b->sphere.position_m, sizeof b->sphere_goal);
        b->sphere_on = true;
    } else if (c->what == LIFT) {
        b->sphere_on = false;
    } else if (c->what == GRASP) {
        *mode = POKE_GRASP;
        body_grasp(b, mm, mm[3]);
    } else if (c->what == RELEASE) {
        body_release(b);
    } else if (c->what == BLADE) {
        *mode = POKE_CUT;
        b->blade_on = false;
        body_slice(b, mm);
    } else if (c->what == SHEATHE) {
        b->blade_on = false;
    } else if (c->what == TEAR) {
        b->tearing = c->value[0] != 0.0;
    }
}

/* One of the frames that a command takes, left of them to come. */
static void go_on(const command *c, int left, body *b, view *v) {
    const double *a = c->value;
    double frames = table[c->what].frames >= 0 ? a[table[c->what].frames] : 1.0, edge[6];
    for (int k = 0; k < 3; k++) {
        if (c->what == PRESS)
            b->sphere_goal[k] += (1e-3 * a[k] - b->sphere_goal[k]) / left;
        if (c->what == DRAG)
            b->hand_goal[k] += 1e-3 * a[k] / frames;
        edge[k] = b->blade[k] + 1e-3 * a[k] / frames;
        edge[3 + k] = b->blade[3 + k] + 1e-3 * a[k] / frames;
    }
    if (c->what == SLICE)
        body_slice(b, edge);
    if (c->what == TURN) {
        v->yaw += a[0] / frames;
        v->pitch += a[1] / frames;
    }
}

void script_frame(script *s, body *b, view *v, poke_mode *mode) {
    while (s->left == 0 && s->next < s->n) {
        const command *c = &s->commands[s->next++];
        start(c, b, mode);
        s->left = table[c->what].frames >= 0 ? (int)c->value[table[c->what].frames] : 0;
    }
    if (s->left > 0) {
        go_on(&s->commands[s->next - 1], s->left, b, v);
        s->left--;
    }
}
