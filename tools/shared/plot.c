/* plot.c: SVG figures by gnuplot; the script with its data stays beside the figure. */
#define _POSIX_C_SOURCE 200809L
#include "plot.h"

#include <errno.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { NAME_MAX_LENGTH = 4096 };

/* Okabe and Ito's palette, told apart by colour-blind readers too. */
static const char *const palette[PLOT_COLOURS] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                  "#56B4E9", "#E69F00", "#000000", "#8C6D31"};

/* Four colours of the viridis scale, dark to light, as red, green, blue. */
static const double shades[4][3] = {{68, 1, 84}, {49, 104, 142}, {31, 158, 137}, {142, 201, 60}};

/* "#rrggbb"; pale: two thirds of the way to white. */
static void colour_code(int colour, bool pale, char code[8]) {
    double rgb[3];
    if (colour >= PLOT_SHADE) {
        double at = 3 * fmin((colour - PLOT_SHADE) / 999.0, 0.9999);
        int k = (int)at;
        for (int i = 0; i < 3; i++) {
            rgb[i] = shades[k][i] + (at - k) * (shades[k + 1][i] - shades[k][i]);
        }
    } else {
        long packed = strtol(palette[colour % PLOT_COLOURS] + 1, NULL, 16);
        rgb[0] = (double)(packed >> 16);
        rgb[1] = (double)(packed >> 8 & 255);
        rgb[2] = (double)(packed & 255);
    }
    for (int i = 0; pale && i < 3; i++) {
        rgb[i] += 0.62 * (255 - rgb[i]);
    }
    snprintf(code, 8, "#%02x%02x%02x", (unsigned)rgb[0] & 255u, (unsigned)rgb[1] & 255u,
             (unsigned)rgb[2] & 255u);
}

bool plot_folder(const char *folder) {
    struct stat entry;
    if (mkdir(folder, 0777) == 0) {
        return true;
    }
    return errno == EEXIST && stat(folder, &entry) == 0 && S_ISDIR(entry.st_mode);
}

/* Quoted for gnuplot: single quotes, with a quote inside doubled. */
static void quote(FILE *to, const char *text) {
    fputc('\'', to);
    for (; *text; text++) {
        if (*text == '\'') {
            fputc('\'', to);
        }
        fputc(*text, to);
    }
    fputc('\'', to);
}

static void write_data(FILE *to, size_t panel, size_t index, const plot_series *series) {
    fprintf(to, "$d%zu_%zu << EOD\n", panel, index);
    for (size_t i = 0; i < series->n; i++) {
        if (isfinite(series->x[i]) && isfinite(series->y[i])) {
            fprintf(to, "%.7g %.7g", series->x[i], series->y[i]);
            if (series->style == PLOT_BARS) {
                fprintf(to, " %.7g %.7g", series->y[series->n + i], series->y[2 * series->n + i]);
            }
            fputc('\n', to);
        }
    }
    fputs("EOD\n", to);
}

static void write_series(FILE *to, size_t panel, size_t index, const plot_series *series) {
    static const char *const looks[] = {"lines lw 2",         "lines lw 2 dt 2",
                                        "points pt 6 ps 0.6", "linespoints lw 2 pt 7 ps 0.7",
                                        "lines lw 1",         "yerrorbars lw 1.5 pt 7 ps 0.6"};
    char code[8];
    colour_code(series->colour, series->style == PLOT_PALE, code);
    fprintf(to, "%s$d%zu_%zu using %s with %s lc rgb '%s' ", index ? ", \\\n     " : "plot ", panel, index,
            series->style == PLOT_BARS ? "1:2:3:4" : "1:2", looks[series->style], code);
    if (series->title) {
        fputs("title ", to);
        quote(to, series->title);
    } else {
        fputs("notitle", to);
    }
}

/* Curves fill the width; points alone keep their distance from the frame. */
static bool has_curves(const plot_figure *figure) {
    for (size_t k = 0; k < figure->n_panels; k++) {
        for (size_t i = 0; i < figure->panel[k].n_series; i++) {
            plot_style style = figure->panel[k].series[i].style;
            if (style == PLOT_LINE || style == PLOT_PALE) {
                return true;
            }
        }
    }
    return false;
}

/* Few whole numbers along x, such as a number of arms. */
static bool is_counted(const plot_panel *p) {
    double low = 0, high = 0;
    for (size_t i = 0; i < p->n_series; i++) {
        for (size_t k = 0; k < p->series[i].n; k++) {
            double x = p->series[i].x[k];
            low = fmin(low, x);
            high = fmax(high, x);
            if (x != floor(x) || p->series[i].style != PLOT_LINE_POINTS) {
                return false;
            }
        }
    }
    return high - low <= 12;
}

/* Steps of 1, 2 or 5 times a power of ten of which two to four make the lower panel's height, which is
 * too low for as many as gnuplot takes; 0 = gnuplot's own. */
static double tic_step(const plot_panel *p) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (size_t i = 0; i < p->n_series; i++) {
        for (size_t k = 0; k < p->series[i].n; k++) {
            low = fmin(low, p->series[i].y[k]);
            high = fmax(high, p->series[i].y[k]);
        }
    }
    double rough = (high - low) / 4;
    if (!(rough > 0) || !isfinite(rough) || p->y_log) {
        return 0;
    }
    double power = pow(10, floor(log10(rough)));
    return power * (rough < 2 * power ? 2 : rough < 5 * power ? 5 : 10);
}

static void write_panel(FILE *to, size_t panel, const plot_figure *figure) {
    const plot_panel *p = &figure->panel[panel];
    bool key = false;
    for (size_t i = 0; i < p->n_series; i++) {
        key = key || p->series[i].title;
    }
    if (figure->n_panels > 1) {
        fprintf(to, panel == 0 ? "set bmargin at screen 0.44\nset tmargin at screen 0.93\n"
                               : "unset title\nset bmargin at screen 0.12\nset tmargin at screen 0.36\n");
        fprintf(to, "set rmargin at screen 0.78\n");
    }
    fprintf(to, "unset logscale\n%s%s",
            p->x_log ? "set logscale x\nset format x '10^{%L}'\n" : "set format x '%g'\n",
            p->y_log ? "set logscale y\n" : "");
    fprintf(to, "set xrange [*:*] %s\nset xtics %s\nset xlabel ", has_curves(figure) ? "noextend" : "extend",
            is_counted(p) ? "1" : "autofreq");
    quote(to, p->x_label);
    fputs(" noenhanced\nset ylabel ", to);
    quote(to, p->y_label);
    fprintf(to, " noenhanced\n%s",
            key ? "set key outside right top vertical Left reverse noenhanced samplen 2 width 2\n"
                : "unset key\n");
    double step = panel > 0 ? tic_step(p) : 0;
    if (step > 0) {
        fprintf(to, "set ytics nomirror %.9g\n", step);
    }
    for (size_t i = 0; i < p->n_series; i++) {
        write_series(to, panel, i, &p->series[i]);
    }
    fputc('\n', to);
}

static bool write_script(const char *script, const char *svg, const plot_figure *figure) {
    FILE *to = fopen(script, "w");
    if (!to) {
        return false;
    }
    fprintf(to, "set encoding utf8\nset terminal svg size 900,560 dynamic font 'DejaVu "
                "Sans,Arial,sans-serif' fontscale 1.3"
                " background rgb 'white'\nset output exists('ARGC') && ARGC > 0 ? ARG1 : ");
    quote(to, svg);
    fputs("\nset grid lc rgb '#dddddd' lt 1\nset border 3\nset tics nomirror\nset lmargin 11\nset title ",
          to);
    quote(to, figure->title);
    fputs(" noenhanced\n", to);
    for (size_t k = 0; k < figure->n_panels; k++) {
        for (size_t i = 0; i < figure->panel[k].n_series; i++) {
            write_data(to, k, i, &figure->panel[k].series[i]);
        }
    }
    if (figure->n_panels > 1) {
        fputs("set multiplot\n", to);
    }
    for (size_t k = 0; k < figure->n_panels; k++) {
        write_panel(to, k, figure);
    }
    if (figure->n_panels > 1) {
        fputs("unset multiplot\n", to);
    }
    fputs("unset output\n", to);
    bool bad = ferror(to) != 0;
    return fclose(to) == 0 && !bad;
}

/* The environment in a locale of UTF-8, without which gnuplot warns of its own degree sign. The caller
 * frees it; NULL = no memory. */
static char **utf8_environment(char *locale) {
    size_t n = 0;
    while (environ[n]) {
        n++;
    }
    char **own = malloc((n + 2) * sizeof *own);
    if (own) {
        own[0] = locale; /* the first of a name counts */
        memcpy(own + 1, environ, (n + 1) * sizeof *own);
    }
    return own;
}

static plot_result run_gnuplot(char *script, char *svg) {
    char program[] = "gnuplot", with_arguments[] = "-c", locale[] = "LC_ALL=C.UTF-8";
    char *arguments[] = {program, with_arguments, script, svg, NULL};
    char **environment = utf8_environment(locale);
    pid_t child;
    int how, code = environment ? posix_spawnp(&child, program, NULL, NULL, arguments, environment) : ENOMEM;
    free(environment);
    if (code) {
        return code == ENOENT ? PLOT_NO_GNUPLOT : PLOT_FAILED;
    }
    while (waitpid(child, &how, 0) < 0) {
        if (errno != EINTR) {
            return PLOT_FAILED;
        }
    }
    if (WIFEXITED(how) && WEXITSTATUS(how) == 127) {
        return PLOT_NO_GNUPLOT;
    }
    return WIFEXITED(how) && WEXITSTATUS(how) == 0 ? PLOT_OK : PLOT_FAILED;
}

plot_result plot_write(const char *folder, const char *name, const plot_figure *figure) {
    char script[NAME_MAX_LENGTH], svg[NAME_MAX_LENGTH], temporary[NAME_MAX_LENGTH];
    int n = snprintf(script, sizeof script, "%s/%s.gp", folder, name);
    int m = snprintf(svg, sizeof svg, "%s/%s.svg", folder, name);
    int k = snprintf(temporary, sizeof temporary, "%s/%s.svg.%ld.tmp", folder, name, (long)getpid());
    if (n < 0 || m < 0 || k < 0 || (size_t)k >= sizeof temporary) { /* the longest of the three */
        return PLOT_FAILED;
    }
    plot_result result = write_script(script, svg, figure) ? run_gnuplot(script, temporary) : PLOT_FAILED;
    if (result == PLOT_OK && rename(temporary, svg) != 0) {
        result = PLOT_FAILED;
    }
    if (result != PLOT_OK) {
        remove(temporary);
    }
    return result;
}
