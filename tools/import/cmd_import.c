/* cmd_import.c: palpate import: other testers' files as experiments. */
#define _POSIX_C_SOURCE 200809L
#include "shared/commands.h"
#include "import.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "import";

static int parse(int argc, char **argv, import_options *o, const char **files, size_t *n) {
    const cli_option options[] = {
        cli_text("out", "DIR", &o->out, "folder of the experiments; made if need be"),
        cli_flag("force", &o->force, "replace recordings that are there"),
        cli_heading("The file"),
        cli_choice("format", "mach1|instron|csv", &o->format,
                   "what wrote it (default: seen from its first lines)"),
        cli_text("map", "LIST", &o->map,
                 "time=COL,depth=COL,force=COL: names or numbers from 1 of the\n"
                 "columns (default: by their names)"),
        cli_text("units", "LIST", &o->units,
                 "time=s|ms|min,depth=mm|um|m|cm|in,force=N|mN|kN|gf|kgf|lbf\n"
                 "(default: as the columns' names say)"),
        cli_count("skip-lines", "N", 0, 1e9, &o->skip_lines,
                  "lines above the names (csv; default: the names are above the\n"
                  "first row of numbers)"),
        cli_choice("separator", ",|;|tab", &o->separator,
                   "between columns (csv; default: seen from the file)"),
        cli_heading("Specimen"),
        cli_positive("specimen-height-mm", "MM", 1e4, &o->height_mm,
                     "height, mm (default: as the file says)"),
        cli_positive("specimen-radius-mm", "MM", 1e4, &o->radius_mm, "radius, mm (default likewise)"),
        cli_text("specimen-kind", "KIND", &o->kind,
                 "cylinder, rigid, none (air: needs no height) or another word"),
        cli_heading("Recording"),
        cli_choice("protocol", "static|ramp_hold|cyclic|other", &o->protocol,
                   "what the plate did (default: from the tester's settings, or as it\n"
                   "moved)"),
        cli_text("negate", "LIST", &o->negate,
                 "depth, force or both: these change sign, or none (default: the\n"
                 "force grows as the plate presses)"),
        cli_choice("contact", "auto|air|start|recorded", &o->contact,
                   "where depth and force are 0 (default auto: after the free air, else\n"
                   "where the plate rests before it moves; instron: as recorded)"),
        cli_text("license", "TEXT", &o->license, "licence of the data, kept in the header"),
    };
    const cli_command command = {
        NAME,
        "FILE ... --out DIR [options]",
        "Turns other testers' recordings into experiments: time_s, depth_mm (positive into the specimen, 0 "
        "at\n"
        "contact), force_N (positive = compression), one DIR/FILE.csv each. Says on stderr what was decided.",
        "  palpate import sample_*.csv --out runs\n"
        "  palpate import mach1/*.csv --specimen-height-mm 2 --out runs\n"
        "  palpate import log.txt --map time=1,depth=3,force=4 --units time=ms,depth=um,force=gf \\\n"
        "      --specimen-height-mm 24 --out runs\n",
        options,
        sizeof options / sizeof options[0]};
    int code = cli_parse(&command, argc, argv, files, (size_t)argc, n);
    if (code) {
        return code;
    }
    if (*n == 0) {
        return cli_usage_error(NAME, "name a FILE; see palpate import --help");
    }
    return o->out ? CLI_OK : cli_usage_error(NAME, "name a folder by --out DIR");
}

/* quantity=value between commas, each quantity once. */
static int check_list(const char *option, const char *list) {
    static const char *const quantities[] = {"time=", "depth=", "force="};
    bool seen[3] = {false, false, false};
    for (const char *at = list; at;) {
        size_t end = strcspn(at, ","), i = 0;
        while (i < 3 && strncmp(at, quantities[i], strlen(quantities[i])) != 0) {
            i++;
        }
        if (i == 3 || seen[i] || end == strlen(quantities[i])) {
            return cli_usage_error(NAME, "--%s wants time=...,depth=...,force=..., not \"%s\"", option, list);
        }
        seen[i] = true;
        at = at[end] ? at + end + 1 : NULL;
    }
    return CLI_OK;
}

static int check_options(const import_options *o) {
    static const char *const signs[] = {"depth", "force", "depth,force", "force,depth", "none"};
    size_t i = 0;
    while (o->negate && i < 5 && strcmp(o->negate, signs[i]) != 0) {
        i++;
    }
    if (i == 5) {
        return cli_usage_error(NAME, "--negate wants depth, force, depth,force or none, not \"%s\"",
                               o->negate);
    }
    int code = check_list("map", o->map);
    return code ? code : check_list("units", o->units);
}

/* No two experiments under one name, and none in the place of a file that is read or of a recording. */
static int check_names(const import_options *o, const import_sources *all) {
    int code = CLI_OK;
    for (size_t i = 0; i < all->n && code == CLI_OK; i++) {
        char path[CLI_PATH_MAX];
        const import_source *s = all->source[i];
        for (size_t j = 0; j < i; j++) {
            if (strcmp(all->source[j]->name, s->name) == 0) {
                return cli_usage_error(NAME,
                                       "%s and %s would both become %s.csv: import them into two folders",
                                       all->source[j]->file, s->file, s->name);
            }
        }
        snprintf(path, sizeof path, "%s/%s.csv", o->out, s->name); /* cut short, it is refused when it is written */
        code = cli_output_check(NAME, path, o->force, o->n_files, o->files);
    }
    return code;
}

static int read_file(const import_options *o, const char *file, import_sources *all) {
    size_t first = all->n;
    int code = import_read(o, file, all);
    for (size_t i = first; code == CLI_OK && i < all->n; i++) {
        code = import_columns(o, all->source[i]);
    }
    return code;
}

/* A block in which the stage stands still is a wait or a setting to zero. */
static bool moves(const import_source *s) {
    for (size_t i = 1; i < s->rows; i++) {
        if (fabs(s->depth_mm[i] - s->depth_mm[0]) > 1e-3) {
            return true;
        }
    }
    return false;
}

/* Signs, contact and protocol of all, before the first file is written. */
static int find_contacts(const import_options *o, import_sources *all) {
    int code = CLI_OK;
    for (size_t i = 0; code == CLI_OK && i < all->n; i++) {
        import_source *s = all->source[i];
        s->skip = *s->block && !s->skip && !moves(s) ? "the stage does not move" : s->skip;
        code = s->skip ? CLI_OK : import_signs(o, s);
    }
    for (int approaches = 1; approaches >= 0; approaches--) {
        for (size_t i = 0; code == CLI_OK && i < all->n; i++) {
            if (!all->source[i]->skip && import_is_approach(all->source[i]) == (approaches == 1)) {
                code = import_contact_find(o, all, all->source[i]);
            }
        }
    }
    for (size_t i = 0; code == CLI_OK && i < all->n; i++) {
        if (!all->source[i]->skip) {
            code = import_specimen(o, all->source[i]);
            import_protocol(o, all->source[i]);
        }
    }
    return code;
}

static int write_all(const import_options *o, const import_sources *all) {
    int code = CLI_OK;
    size_t written = 0;
    if (cli_folder(NAME, o->out)) {
        return CLI_FAILURE;
    }
    for (size_t i = 0; code == CLI_OK && i < all->n; i++) {
        const import_source *s = all->source[i];
        if (s->skip) {
            fprintf(stderr, "palpate import: %s: block %s left out: %s\n", s->file, s->block, s->skip);
        } else {
            code = import_write(o, s);
            written++;
        }
    }
    return code || written ? code : cli_failure(NAME, "nothing to import in the files named");
}

int cmd_import(int argc, char **argv) {
    import_options o = {.format = -1, .protocol = -1, .separator = -1, .skip_lines = SIZE_MAX};
    import_sources all = {0};
    size_t n = 0;
    const char **files = malloc((size_t)argc * sizeof(char *));
    if (!files) {
        return cli_failure(NAME, "out of memory");
    }
    int code = parse(argc, argv, &o, files, &n);
    bool helped = code == CLI_HELP;
    o.files = files;
    o.n_files = n;
    code = code ? code : check_options(&o);
    for (size_t i = 0; code == CLI_OK && i < n; i++) {
        code = read_file(&o, files[i], &all);
    }
    code = code ? code : check_names(&o, &all);
    code = code ? code : find_contacts(&o, &all);
    code = code ? code : write_all(&o, &all);
    import_free(&all);
    free(files);
    return helped ? CLI_OK : code;
}
