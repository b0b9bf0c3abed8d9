/* cmd_import.c: palpate import: other testers' files as experiments. */
#define _POSIX_C_SOURCE 200809L
#include "shared/commands.h"
#include "import.h"

#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char NAME[] = "import";

static int parse(int argc, char **argv, import_options *o, const char **files, size_t *n) {
    const cli_option options[] = {
        cli_text("out", "DIR|FILE", &o->out,
                 "folder for the experiments, created if it does not exist; or one file: RUN.csv,\n"
                 "or RUN.h5, in which an experiment of palpate is written as HDF5"),
        cli_flag("force", &o->force, "replace existing recordings"),
        cli_heading("The file"),
        cli_choice("format", "mach1|instron|csv", &o->format,
                   "kind of file (default: recognized by its first lines)"),
        cli_text("map", "LIST", &o->map,
                 "the columns: time=COL,depth=COL,force=COL (or strain=, stress=,\n"
                 "deflection=); COL is a name, or a number from 1 (default: by name)"),
        cli_text("units", "LIST", &o->units,
                 "time=s|ms|min,depth=mm|um|nm|m|%|stretch,force=N|mN|gf|kPa|...\n"
                 "(default: from the columns' names, or from a row below them)"),
        cli_positive("rate", "HZ", 1e9, &o->rate_Hz,
                     "sampling rate, Hz, where the table has no time or a wrong one\n"
                     "(default: from the file)"),
        cli_count("skip-lines", "N", 0, 1e9, &o->skip_lines,
                  "lines before the row of column names (csv; default: that row is\n"
                  "directly above the first numbers)"),
        cli_choice("separator", ",|;|tab|space", &o->separator,
                   "character between columns (csv; default: found in the file)"),
        cli_flag("strict", &o->strict,
                 "stop at rows that are not numbers or repeat a time (default: skip\n"
                 "and count them)"),
        cli_number("from", "S", -1e12, 1e12, &o->from_s, "skip samples before this time, s"),
        cli_number("to", "S", -1e12, 1e12, &o->to_s, "skip samples after this time, s"),
        cli_heading("Specimen"),
        cli_positive("specimen-height-mm", "MM", 1e4, &o->height_mm, "height, mm (default: from the file)"),
        cli_positive("specimen-radius-mm", "MM", 1e4, &o->radius_mm, "radius, mm (default: from the file)"),
        cli_positive("specimen-area-mm2", "MM2", 1e8, &o->area_mm2,
                     "cross-sectional area, mm2, instead of the radius"),
        cli_text("specimen-name", "NAME", &o->specimen, "name of the specimen"),
        cli_text("specimen-kind", "KIND", &o->kind,
                 "cylinder, rigid, none (only air; no height needed) or another word"),
        cli_choice("tip", "plate|flat|sphere|cone", &o->tip,
                   "shape of the indenter: a plate over the whole face, or a flat punch, sphere or\n"
                   "cone on a wide layer (default: from the file)"),
        cli_positive("tip-radius-mm", "R", 1e4, &o->tip_radius_mm,
                     "radius of the punch or sphere, mm (default: from the file)"),
        cli_positive("tip-angle-deg", "A", 90, &o->tip_angle_deg,
                     "half angle of the cone, from its axis, degrees"),
        cli_heading("Recording"),
        cli_choice("protocol", "static|ramp_hold|cyclic|other", &o->protocol,
                   "motion of the plate (default: from the tester's settings or the\n"
                   "recorded motion)"),
        cli_text("negate", "LIST", &o->negate,
                 "depth, force, depth,force or none: what to change the sign of\n"
                 "(default: so that the force grows with depth)"),
        cli_choice("contact", "auto|air|start|recorded", &o->contact,
                   "where depth and force are 0 (default auto: where free air ends, else\n"
                   "where the plate rests before it moves; instron: as recorded)"),
        cli_positive(
            "spring-N-m", "N/m", 1e6, &o->spring_N_m,
            "stiffness of the cantilever, if the file records its deflection\n(default: from the file)"),
        cli_text("session-start", "TIME", &o->session,
                 "start of the session, 2024-03-01T10:00:00 or 10:00:00; each run keeps\n"
                 "its delay after it (default of a folder: start of the first run)"),
        cli_text("license", "TEXT", &o->license, "licence of the data, written to the header"),
    };
    const cli_command command = {
        NAME,
        "FILE|FOLDER ... --out DIR|FILE [options]",
        "Converts recordings of other testers to experiments, one DIR/FILE.csv each, with time_s, depth_mm\n"
        "(positive into the specimen, 0 at contact) and force_N (positive = compression). A table on stderr\n"
        "shows how each file was read. The files of a FOLDER are one session, in the order of recording.",
        "  palpate import sample_*.csv --out runs\n"
        "  palpate import mach1/*.csv --specimen-height-mm 2 --out runs\n"
        "  palpate import log.txt --map time=1,depth=3,force=4 --units time=ms,depth=um,force=gf \\\n"
        "      --specimen-height-mm 24 --out runs\n"
        "  palpate import run.csv --out run.h5\n",
        options,
        sizeof options / sizeof options[0]};
    int code = cli_parse(&command, argc, argv, files, (size_t)argc, n);
    if (code)
        return code;
    if (*n == 0)
        return cli_usage_error(NAME, "name a FILE; see palpate import --help");
    return o->out ? CLI_OK : cli_usage_error(NAME, "name the folder of the experiments by --out DIR");
}

/* quantity=value between commas, each quantity once. */
static int check_list(const char *option, const char *list) {
    static const char *const quantities[ROLES] = {
        "time=", "depth=", "force=", "stress=", "strain=", "deflection="};
    bool seen[ROLES] = {false};
    for (const char *at = list; at;) {
        size_t end = strcspn(at, ","), i = 0;
        while (i < ROLES && strncmp(at, quantities[i], strlen(quantities[i])) != 0)
            i++;
        if (i == ROLES || seen[i] || end == strlen(quantities[i]))
            return cli_usage_error(NAME, "--%s must be time=...,depth=...,force=..., not \"%s\"", option,
                                   list);
        seen[i] = true;
        at = at[end] ? at + end + 1 : NULL;
    }
    return CLI_OK;
}

static int check_options(const import_options *o) {
    static const char *const signs[] = {"depth", "force", "depth,force", "force,depth", "none"};
    size_t i = 0;
    while (o->negate && i < 5 && strcmp(o->negate, signs[i]) != 0)
        i++;
    if (i == 5)
        return cli_usage_error(NAME, "--negate must be depth, force, depth,force or none, not \"%s\"",
                               o->negate);
    if (o->rate_Hz > 0 && o->map && strstr(o->map, "time="))
        return cli_usage_error(NAME, "--rate and --map time= both set the time; leave one out");
    int code = check_list("map", o->map);
    return code ? code : check_list("units", o->units);
}

/* Every experiment has its own name, and replaces neither an input nor a recording. */
static int check_names(const import_options *o, const import_sources *all) {
    int code = CLI_OK;
    for (size_t i = 0; i < all->n && code == CLI_OK; i++) {
        char path[CLI_PATH_MAX];
        const import_source *s = all->source[i];
        for (size_t j = 0; j < i; j++) {
            if (strcmp(all->source[j]->name, s->name) == 0)
                return cli_usage_error(NAME,
                                       "%s and %s would both become %s.csv: import them into two folders",
                                       all->source[j]->file, s->file, s->name);
        }
        if (import_out_is_file(o) && all->n > 1)
            return cli_usage_error(NAME, "%s: is one file for %zu recordings; name a folder by --out DIR",
                                   o->out, all->n);
        code = import_out_path(o, s->name, path);
        code = code ? code : cli_output_check(NAME, path, o->force, o->n_files, o->files);
    }
    return code;
}

static int read_file(const import_options *o, const char *file, import_sources *all) {
    size_t first = all->n;
    int code = import_read(o, file, all);
    for (size_t i = first; code == CLI_OK && i < all->n; i++)
        code = import_columns(o, all->source[i]);
    return code;
}

/* A block in which the stage moves by a few steps of its resolution at most is a wait or a zeroing. */
static bool moves(const import_source *s) {
    double low = s->depth_mm[0], high = low, step = HUGE_VAL;
    for (size_t i = 1; i < s->rows; i++) {
        double change = fabs(s->depth_mm[i] - s->depth_mm[i - 1]);
        step = change > 0 ? fmin(step, change) : step;
        low = fmin(low, s->depth_mm[i]);
        high = fmax(high, s->depth_mm[i]);
    }
    return high - low > 5 * step;
}

/* Finds signs, contact and protocol of all files before the first one is written. */
static int find_contacts(const import_options *o, import_sources *all) {
    int code = CLI_OK;
    for (size_t i = 0; code == CLI_OK && i < all->n; i++) {
        import_source *s = all->source[i];
        s->skip = *s->block && !s->skip && !moves(s) ? "the stage does not move" : s->skip;
        code = s->skip ? CLI_OK : import_signs(o, s);
        code = code || s->skip ? code : import_contact_rule(o, s);
    }
    if (code == CLI_OK && o->contact == CONTACT_AUTO)
        import_contact_agree(all);
    for (int approaches = 1; approaches >= 0; approaches--) {
        for (size_t i = 0; code == CLI_OK && i < all->n; i++)
            if (!all->source[i]->skip && import_is_approach(all->source[i]) == (approaches == 1))
                code = import_contact_find(o, all, all->source[i]);
    }
    for (size_t i = 0; code == CLI_OK && i < all->n; i++) {
        if (!all->source[i]->skip) {
            code = import_specimen_check(o, all->source[i]);
            code = code ? code : import_protocol(o, all->source[i]);
        }
    }
    return code;
}

static int write_all(const import_options *o, const import_sources *all) {
    int code = CLI_OK;
    size_t written = 0;
    if (!import_out_is_file(o) && cli_folder(NAME, o->out))
        return CLI_FAILURE;
    for (size_t i = 0; code == CLI_OK && i < all->n; i++) {
        const import_source *s = all->source[i];
        if (s->skip) {
            cli_note(NAME, "%s: block %s left out: %s", s->file, s->block, s->skip);
        } else {
            code = import_write(o, s);
            written++;
        }
    }
    if (code == CLI_OK && written > 0)
        import_say(all);
    return code || written ? code : cli_failure(NAME, "the files named have nothing to import");
}

typedef struct names {
    size_t n, capacity;
    char **name; /* [n] owned */
} names;

static bool add_name(names *list, const char *folder, const char *file) {
    char **larger = import_grow(list->name, list->n, &list->capacity, sizeof *larger);
    size_t room = strlen(folder) + strlen(file) + 2;
    char *name = larger ? malloc(room) : NULL;
    list->name = larger ? larger : list->name;
    if (!name)
        return false;
    snprintf(name, room, "%s%s%s", folder, *folder ? "/" : "", file);
    list->name[list->n++] = name;
    return true;
}

static int by_name(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* The files of a folder without hidden ones, sorted by name. */
static int add_folder(names *list, const char *folder, DIR *open) {
    size_t first = list->n;
    for (struct dirent *entry; (entry = readdir(open));) {
        struct stat about;
        if (*entry->d_name == '.')
            continue;
        if (!add_name(list, folder, entry->d_name))
            return cli_failure(NAME, "out of memory");
        if (stat(list->name[list->n - 1], &about) || !S_ISREG(about.st_mode))
            free(list->name[--list->n]);
    }
    if (list->n == first)
        return cli_failure(NAME, "%s: no files in the folder", folder);
    qsort(list->name + first, list->n - first, sizeof *list->name, by_name);
    return CLI_OK;
}

static int find_files(import_options *o, size_t n, const char **words, names *list) {
    int code = CLI_OK;
    for (size_t i = 0; code == CLI_OK && i < n; i++) {
        DIR *open = opendir(words[i]);
        if (open) {
            code = add_folder(list, words[i], open);
            closedir(open);
            o->folder = true;
        } else if (!add_name(list, "", words[i])) {
            code = cli_failure(NAME, "out of memory");
        }
    }
    o->files = (const char **)list->name;
    o->n_files = list->n;
    return code;
}

static int import_all(import_options *o, import_sources *all) {
    int code = check_options(o);
    code = code ? code : import_convert(o);
    if (code == CLI_OK && o->n_files == 0)
        return CLI_OK; /* nothing remains to be imported */
    for (size_t i = 0; code == CLI_OK && i < o->n_files; i++)
        code = read_file(o, o->files[i], all);
    code = code ? code : check_names(o, all);
    code = code ? code : find_contacts(o, all);
    code = code ? code : import_session(o, all);
    return code ? code : write_all(o, all);
}

int cmd_import(int argc, char **argv) {
    import_options o = {.format = -1,
                        .protocol = -1,
                        .separator = -1,
                        .tip = -1,
                        .skip_lines = SIZE_MAX,
                        .from_s = NAN,
                        .to_s = NAN};
    import_sources all = {0};
    names list = {0};
    size_t n = 0;
    const char **words = malloc((size_t)argc * sizeof(char *));
    if (!words)
        return cli_failure(NAME, "out of memory");
    int code = parse(argc, argv, &o, words, &n);
    bool helped = code == CLI_HELP;
    code = code ? code : find_files(&o, n, words, &list);
    code = code ? code : import_all(&o, &all);
    import_free(&all);
    for (size_t i = 0; i < list.n; i++)
        free(list.name[i]);
    free(list.name);
    free(words);
    return helped ? CLI_OK : code;
}
