/* import_hdf5.c: HDF5 files, by the program palpate-hdf5: their tables as text, and experiments of palpate.
 */
#include "import.h"
#include "shared/beside.h"
#include "shared/crc32.h"

#include <stdlib.h>
#include <string.h>

static const char NAME[] = "import";

enum { OTHER = 3 }; /* exit code of palpate-hdf5: the file is no experiment of palpate */

/* The format's first eight bytes stand at 0, 512, 1024, 2048, ...; MATLAB writes text of its own before
 * them. */
bool import_hdf5_is(const char *file) {
    static const char first[] = {'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
    char bytes[sizeof first];
    bool found = false, more = true;
    FILE *from = fopen(file, "rb");
    for (long at = 0; from && more && !found && at <= 1 << 20; at = at ? 2 * at : 512) {
        more = fseek(from, at, SEEK_SET) == 0 && fread(bytes, 1, sizeof bytes, from) == sizeof bytes;
        found = more && memcmp(bytes, first, sizeof first) == 0;
    }
    if (from)
        fclose(from);
    return found;
}

/* Runs palpate-hdf5, which prints its own messages about a file. OTHER is passed on. */
static int run(const char *how, const char *file, const char *out, char **text, size_t *size) {
    char program[CLI_PATH_MAX];
    int code;
    if (!beside_command("palpate-hdf5", program))
        return cli_failure(NAME,
                           "%s: this palpate was built without HDF5; install libhdf5-dev and build it again",
                           out && import_hdf5_is(file) ? file
                           : out                       ? out
                                                       : file);
    const char *const words[] = {program, how, "FILE", out, NULL};
    *text = import_run(words, file, false, size, &code);
    if (code == CLI_OK && !*text)
        return cli_failure(NAME, "%s: out of memory", file);
    return code == CLI_OK || code == CLI_FAILURE || code == OTHER
               ? code
               : cli_failure(NAME, "%s: the HDF5 file is damaged: its reader crashed or did not end", file);
}

static int sum_up(import_text *text) {
    static const size_t BLOCK = 1 << 16;
    FILE *from = fopen(text->file, "rb");
    char *bytes = malloc(BLOCK);
    for (size_t n; from && bytes && (n = fread(bytes, 1, BLOCK, from)) > 0; text->size += n)
        text->crc32 = crc32_add(text->crc32, bytes, n);
    bool good = from && bytes && !ferror(from);
    if (from)
        fclose(from);
    free(bytes);
    return good ? CLI_OK : cli_failure(NAME, "%s: cannot be read", text->file);
}

int import_hdf5_read(import_text *text) {
    size_t size;
    int code = sum_up(text);
    return code ? code : run("print", text->file, NULL, &text->text, &size);
}

/* Whether a file is an experiment CSV. */
static bool is_experiment(const char *file) {
    char top[4096];
    FILE *from = fopen(file, "r");
    size_t n = from ? fread(top, 1, sizeof top - 1, from) : 0;
    top[n] = '\0';
    if (from)
        fclose(from);
    return strncmp(top, "# palpate.experiment", 20) == 0 || strstr(top, "\n# palpate.experiment");
}

/* To a CSV from HDF5, or from a CSV to HDF5. */
static int convert(const import_options *o, const char *file, bool to_hdf5) {
    char path[CLI_PATH_MAX], name[CLI_PATH_MAX], *text = NULL;
    const char *base = cli_base(file), *dot = strrchr(base, '.');
    size_t size;
    snprintf(name, sizeof name, "%.*s", (int)(dot && dot > base ? (size_t)(dot - base) : strlen(base)), base);
    int code = import_out_path(o, name, path);
    code = code ? code : cli_output_check(NAME, path, o->force, o->n_files, o->files);
    code = code ? code : run(to_hdf5 ? "write" : "read", file, path, &text, &size);
    free(text);
    return code;
}

int import_convert(import_options *o) {
    const char *end = strrchr(cli_base(o->out), '.');
    bool to_hdf5 = import_out_is_file(o) && strcmp(end, ".csv") != 0;
    size_t left = 0;
    if (to_hdf5 && (o->n_files != 1 || !is_experiment(o->files[0])))
        return cli_failure(
            NAME, "%s: takes one experiment CSV of palpate; import other files to a folder first", o->out);
    for (size_t i = 0; i < o->n_files; i++) {
        int code = to_hdf5 || import_hdf5_is(o->files[i]) ? convert(o, o->files[i], to_hdf5) : OTHER;
        if (code != CLI_OK && code != OTHER)
            return code;
        if (code == OTHER)
            o->files[left++] = o->files[i];
    }
    o->n_files = left;
    return CLI_OK;
}
