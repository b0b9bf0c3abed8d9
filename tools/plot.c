/* plot.c: SVG figures by gnuplot; the script with its data stays beside the figure. */
#define _POSIX_C_SOURCE 200809L
#include "plot.h"

#include <errno.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { NAME_MAX_LENGTH = 4096 };

/* Okabe and Ito's palette, told apart by colour-blind readers too. */
static const char *const palette[PLOT_COLOURS] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                  "#56B4E9", "#E69F00", "#000000", "#8C6D31"};

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
            fprintf(to, "%.9g %.9g\n", series->x[i], series->y[i]);
        }
    }
    fputs("EOD\n", to);
}

static void write_series(FILE *to, size_t panel, size_t index, const plot_series *series) {
    static const char *const looks[] = {"lines lw 2", "lines lw 2 dt 2", "points pt 6 ps 0.6",
                                        "linespoints lw 2 pt 7 ps 0.7"};
    fprintf(to, "%s$d%zu_%zu using 1:2 with %s lc rgb '%s' ", index ? ", \\\n     " : "plot ", panel, index,
            looks[series->style], palette[series->colour % PLOT_COLOURS]);
    if (series->title) {
        fputs("title ", to);
        quote(to, series->title);
    } else {
        fputs("notitle", to);
    }
}

static void write_panel(FILE *to, size_t panel, size_t n_panels, const plot_panel *p) {
    bool key = false;
    for (size_t i = 0; i < p->n_series; i++) {
        key = key || p->series[i].title;
    }
    if (n_panels > 1) {
        fprintf(to, panel == 0 ? "set bmargin at screen 0.40\nset tmargin at screen 0.93\n"
                               : "unset title\nset bmargin at screen 0.11\nset tmargin at screen 0.31\n");
        fprintf(to, "set rmargin at screen 0.80\n");
    }
    fprintf(to, "unset logscale\n%s%s",
            p->x_log ? "set logscale x\nset format x '10^{%L}'\n" : "set format x '%g'\n",
            p->y_log ? "set logscale y\n" : "");
    fputs("set xlabel ", to);
    quote(to, p->x_label);
    fputs("\nset ylabel ", to);
    quote(to, p->y_label);
    fprintf(to, "\n%s", key ? "set key outside right top vertical Left reverse samplen 2\n" : "unset key\n");
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
                "Sans,Arial,sans-serif' fontscale 1.15"
                " background rgb 'white'\nset output exists('ARGC') && ARGC > 0 ? ARG1 : ");
    quote(to, svg);
    fputs("\nset grid lc rgb '#dddddd' lt 1\nset border 3\nset tics nomirror\nset lmargin 11\nset title ",
          to);
    quote(to, figure->title);
    fputc('\n', to);
    for (size_t k = 0; k < figure->n_panels; k++) {
        for (size_t i = 0; i < figure->panel[k].n_series; i++) {
            write_data(to, k, i, &figure->panel[k].series[i]);
        }
    }
    if (figure->n_panels > 1) {
        fputs("set multiplot\n", to);
    }
    for (size_t k = 0; k < figure->n_panels; k++) {
        write_panel(to, k, figure->n_panels, &figure->panel[k]);
    }
    if (figure->n_panels > 1) {
        fputs("unset multiplot\n", to);
    }
    fputs("unset output\n", to);
    bool bad = ferror(to) != 0;
    return fclose(to) == 0 && !bad;
}

static plot_result run_gnuplot(char *script, char *svg) {
    char program[] = "gnuplot", with_arguments[] = "-c";
    char *arguments[] = {program, with_arguments, script, svg, NULL};
    pid_t child;
    int how, code = posix_spawnp(&child, program, NULL, NULL, arguments, environ);
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
