/* plot.c: figures as SVG, drawn by gnuplot. */
#define _POSIX_C_SOURCE 200809L
#include "plot.h"

#include "cli.h"

#include <errno.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

extern char **environ;

/* Okabe and Ito's palette, told apart by colour-blind readers too. */
static const unsigned palette[PLOT_COLOURS] = {0x0072B2, 0xD55E00, 0x009E73, 0xCC79A7,
                                               0x56B4E9, 0xE69F00, 0x000000, 0x8C6D31};

/* Four colours of the viridis scale, dark to light, as red, green, blue. */
static const double shades[4][3] = {{68, 1, 84}, {49, 104, 142}, {31, 158, 137}, {142, 201, 60}};

static unsigned colour_code(int colour) {
    unsigned code = 0;
    if (colour < PLOT_SHADE)
        return palette[colour % PLOT_COLOURS];
    double at = 3 * fmin((colour - PLOT_SHADE) / 999.0, 0.9999);
    int k = (int)at;
    for (int i = 0; i < 3; i++)
        code = code << 8 | (unsigned)(shades[k][i] + (at - k) * (shades[k + 1][i] - shades[k][i]));
    return code;
}

/* ---- the script ---- */

/* Quoted for gnuplot: single quotes, with a quote inside doubled. */
static void quote(FILE *to, const char *before, const char *text, const char *after) {
    fprintf(to, "%s'", before);
    for (; *text; text++) {
        fputs(*text == '\'' ? "'" : "", to);
        fputc(*text, to);
    }
    fprintf(to, "'%s", after);
}

static void write_data(FILE *to, size_t index, const plot_series *series) {
    size_t columns = series->style == PLOT_BARS ? 3 : series->style == PLOT_BAND ? 2 : 1;
    fprintf(to, "$d%zu << EOD\n", index);
    for (size_t i = 0; i < series->n; i++) {
        if (isfinite(series->x[i]) && isfinite(series->y[i])) {
            fprintf(to, "%.7g", series->x[i]);
            for (size_t k = 0; k < columns; k++)
                fprintf(to, " %.7g", series->y[k * series->n + i]);
            fputc('\n', to);
        }
    }
    fputs("EOD\n", to);
}

static void write_series(FILE *to, size_t index, const plot_series *series) {
    static const char *const looks[] = {"1:2 with lines lw 2",
                                        "1:2 with lines lw 2 dt 2",
                                        "1:2 with points pt 6 ps 0.6",
                                        "1:2 with linespoints lw 2 pt 7 ps 0.7",
                                        "1:2 with lines lw 1.5",
                                        "1:2:3:4 with yerrorbars lw 1.5 pt 7 ps 0.6",
                                        "1:2:3 with filledcurves fillstyle solid noborder"};
    unsigned clear = series->style == PLOT_PALE ? 0x70 : series->style == PLOT_BAND ? 0xC8 : 0;
    fprintf(to, "%s$d%zu using %s lc rgb '#%02x%06x'", index ? ", \\\n     " : "plot ", index,
            looks[series->style], clear, colour_code(series->colour));
    quote(to, " title ", series->title ? series->title : "", "");
}

static void write_axis(FILE *to, char axis, plot_scale scale, const char *label) {
    if (scale != PLOT_LINEAR)
        fprintf(to, "set logscale %c\n", axis);
    if (scale == PLOT_LOG_FINE)
        fprintf(to, "set %crange [*:*] noextend\nset for [k=-9:9] %ctics add (10.**k, 2*10.**k, 5*10.**k)\n",
                axis, axis);
    fprintf(to, "set format %c '%s'\nset %clabel ", axis, scale == PLOT_LOG && axis == 'x' ? "10^{%L}" : "%g",
            axis);
    quote(to, "", label, " noenhanced\n");
}

static void write_panel(FILE *to, const plot_panel *p) {
    bool key = false, curves = false;
    for (size_t i = 0; i < p->n_series; i++) {
        key = key || p->series[i].title;
        curves = curves || p->series[i].style == PLOT_LINE || p->series[i].style == PLOT_PALE;
        write_data(to, i, &p->series[i]);
    }
    if (p->title)
        quote(to, "set title ", p->title, " noenhanced\n");
    /* curves fill the width; points alone keep their distance from the frame */
    fprintf(to, "unset logscale\nset xrange [*:*] %s\nset xtics %s\nset yrange [*:*]\n",
            curves ? "noextend" : "extend", p->x_counts ? "1" : "autofreq");
    if (p->y_high > p->y_low)
        fprintf(to, "set yrange [%.7g:%.7g]\n", p->y_low, p->y_high);
    write_axis(to, 'x', p->x_scale, p->x_label);
    write_axis(to, 'y', p->y_scale, p->y_label);
    fputs(key ? "set key outside right top vertical Left reverse noenhanced samplen 2 width 2\n"
              : "unset key\n",
          to);
    for (size_t i = 0; i < p->n_series; i++)
        write_series(to, i, &p->series[i]);
    fputc('\n', to);
}

/* Letters of the longest title in the key. */
static size_t longest_title(const plot_figure *figure) {
    size_t most = 0;
    for (size_t k = 0; k < figure->n_panels; k++)
        for (size_t i = 0; i < figure->panel[k].n_series; i++) {
            const char *title = figure->panel[k].series[i].title;
            most = title && strlen(title) > most ? strlen(title) : most;
        }
    return most;
}

/* Panel k of two, one above the other: both as wide as leaves room for the key. */
static void write_margins(FILE *to, const plot_figure *figure, size_t k) {
    enum { LETTER = 10, SAMPLE = 70 };
    double width = figure->width ? figure->width : 900,
           key = (double)(LETTER * longest_title(figure) + SAMPLE) / width;
    if (k == 0)
        fprintf(to, "set bmargin at screen 0.44\nset tmargin at screen 0.93\nset rmargin at screen %.3f\n",
                key < 0.22  ? 0.78
                : key > 0.5 ? 0.5
                            : 1 - key);
    else
        fputs("unset title\nset bmargin at screen 0.12\nset tmargin at screen 0.36\n", to);
}

static void write_script(FILE *to, const plot_figure *figure) {
    size_t n = figure->n_panels, columns = figure->columns ? figure->columns : 1;
    bool pair = n == 2 && columns == 1;
    fprintf(to,
            "set encoding utf8\nset terminal svg size %u,%u dynamic font 'DejaVu Sans,Arial,sans-serif' "
            "fontscale %s background rgb 'white'\nset grid lc rgb '#dddddd' lt 1\nset border 3\n"
            "set tics nomirror\nset lmargin 11\n",
            figure->width ? figure->width : 900, figure->height ? figure->height : 560,
            figure->height ? "1" : "1.3");
    if (figure->title)
        quote(to, "set title ", figure->title, " noenhanced\n");
    if (n > 1)
        fprintf(to, pair ? "set multiplot\n" : "set multiplot layout %zu,%zu\n", (n + columns - 1) / columns,
                columns);
    for (size_t k = 0; k < n; k++) {
        if (pair)
            write_margins(to, figure, k);
        write_panel(to, &figure->panel[k]);
    }
    fputs(n > 1 ? "unset multiplot\n" : "", to);
}

/* ---- gnuplot ---- */

/* Runs the script; in a locale of UTF-8, without which gnuplot warns of its own degree sign. */
static plot_result run(FILE *script, FILE *svg) {
    char env[] = "env", locale[] = "LC_ALL=C.UTF-8", program[] = "gnuplot";
    char *arguments[] = {env, locale, program, NULL};
    posix_spawn_file_actions_t files;
    pid_t child;
    int how = 0;
    if (fflush(script) != 0 || ferror(script) || fseek(script, 0, SEEK_SET) != 0 ||
        posix_spawn_file_actions_init(&files) != 0) {
        return PLOT_FAILED;
    }
    posix_spawn_file_actions_adddup2(&files, fileno(script), 0);
    posix_spawn_file_actions_adddup2(&files, fileno(svg), 1);
    int code = posix_spawnp(&child, env, &files, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&files);
    if (code)
        return code == ENOENT ? PLOT_NO_GNUPLOT : PLOT_FAILED;
    while (waitpid(child, &how, 0) < 0)
        if (errno != EINTR)
            return PLOT_FAILED;
    if (WIFEXITED(how) && WEXITSTATUS(how) == 127)
        return PLOT_NO_GNUPLOT;
    return WIFEXITED(how) && WEXITSTATUS(how) == 0 ? PLOT_OK : PLOT_FAILED;
}

/* The whole of a file; NULL = it is empty, or no memory. */
static char *read_back(FILE *from) {
    long size = fseek(from, 0, SEEK_END) == 0 ? ftell(from) : -1;
    char *text = size > 0 && fseek(from, 0, SEEK_SET) == 0 ? calloc(1, (size_t)size + 1) : NULL;
    if (text && fread(text, 1, (size_t)size, from) == (size_t)size)
        return text;
    free(text);
    return NULL;
}

/* What gnuplot makes of it, whole, with what stands before "<svg". */
static plot_result draw(const plot_figure *figure, char **text) {
    FILE *script = tmpfile(), *to = tmpfile();
    plot_result result = PLOT_FAILED;
    *text = NULL;
    if (script && to) {
        write_script(script, figure);
        result = run(script, to);
    }
    if (result == PLOT_OK) {
        *text = read_back(to);
        result = *text && strstr(*text, "</svg>") ? PLOT_OK : PLOT_FAILED;
    }
    if (script)
        fclose(script);
    if (to)
        fclose(to);
    return result;
}

plot_result plot_svg(const plot_figure *figure, char **svg) {
    plot_result result = draw(figure, svg);
    const char *start = result == PLOT_OK ? strstr(*svg, "<svg") : NULL;
    if (start) {
        memmove(*svg, start, strlen(start) + 1);
        return PLOT_OK;
    }
    free(*svg);
    *svg = NULL;
    return result == PLOT_OK ? PLOT_FAILED : result;
}

/* ---- figures of a command ---- */

/* Script and figure, both or neither. */
static plot_result save(const plot_book *book, const char *name, const plot_figure *figure,
                        const char *text) {
    char path[2][CLI_PATH_MAX];
    palp_file script, svg;
    palp_error error;
    int n = snprintf(path[0], sizeof path[0], "%s/%s.svg", book->folder, name);
    snprintf(path[1], sizeof path[1], "%s/%s.gp", book->folder, name); /* shorter */
    if (n < 0 || (size_t)n >= sizeof path[0] || cli_file_open(book->command, path[0], &svg))
        return PLOT_FAILED;
    if (cli_file_open(book->command, path[1], &script)) {
        palp_file_abandon(&svg);
        return PLOT_FAILED;
    }
    write_script(script.stream, figure);
    fputs(text, svg.stream);
    if (palp_file_commit_pair(&script, &svg, false, &error)) {
        cli_status(book->command, error.status, &error);
        return PLOT_FAILED;
    }
    return PLOT_OK;
}

static plot_result write_files(const plot_book *book, const char *name, const plot_figure *figure) {
    char *text;
    plot_result result = draw(figure, &text);
    if (result == PLOT_OK)
        result = save(book, name, figure, text);
    free(text);
    return result;
}

void plot_draw(plot_book *book, const char *name, const plot_figure *figure) {
    char *svg = NULL;
    plot_result result;
    if (book->result == PLOT_NO_GNUPLOT)
        return;
    if (book->folder)
        result = write_files(book, name, figure);
    else
        result = plot_svg(figure, &svg);
    if (svg)
        book->take(book->user, name, svg);
    if (result != PLOT_OK)
        book->result = result;
}

int plot_close(const plot_book *book) {
    if (book->result == PLOT_NO_GNUPLOT)
        cli_warning(book->command, "gnuplot is not installed: figures are missing");
    return book->result == PLOT_FAILED ? cli_failure(book->command, "a figure could not be drawn") : CLI_OK;
}
