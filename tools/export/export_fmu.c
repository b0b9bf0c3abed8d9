/* export_fmu.c: a model as an FMU: its description, the library that steps it and the model in one archive.
 */
#define _POSIX_C_SOURCE 200809L
#include "export_fmu.h"
#include "export_fmu_description.h"
#include "shared/beside.h"
#include "shared/cli.h"
#include "shared/crc32.h"
#include "shared/opening.h"

#include <errno.h>
#include <palpate/network.h>
#include <palpate/version.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "export";

#ifdef PALPATE_ZIP
#include <zip.h>

#if defined(__x86_64__)
#define PLATFORM "x86_64-linux"
#elif defined(__aarch64__)
#define PLATFORM "aarch64-linux"
#else
#define PLATFORM "x86-linux"
#endif

/* Adds bytes under a name, with the same date always: the same model gives the same file. */
static bool add(zipFile to, const char *name, const char *bytes, size_t n) {
    zip_fileinfo about = {.tmz_date = {.tm_mday = 1, .tm_year = 1980}, .external_fa = 0100644UL << 16};
    bool good = zipOpenNewFileInZip(to, name, &about, NULL, 0, NULL, 0, NULL, Z_DEFLATED, 6) == ZIP_OK;
    for (size_t part; good && n > 0; bytes += part, n -= part) {
        part = n < 1 << 20 ? n : 1 << 20;
        good = zipWriteInFileInZip(to, bytes, (unsigned)part) == ZIP_OK;
    }
    return good && zipCloseFileInZip(to) == ZIP_OK;
}

typedef struct part {
    const char *name;
    char *bytes; /* malloc'ed */
    size_t n;
} part;

static palp_status write_archive(const char *out, size_t n, const part *parts, palp_error *error) {
    palp_file file;
    palp_status status = palp_file_begin(&file, out, error);
    if (status)
        return status;
    errno = 0;
    zipFile to = *file.temporary ? zipOpen(file.temporary, APPEND_STATUS_CREATE) : NULL;
    bool good = to != NULL;
    for (size_t i = 0; i < n; i++)
        good = good && add(to, parts[i].name, parts[i].bytes, parts[i].n);
    good = (!to || zipClose(to, NULL) == ZIP_OK) && good;
    if (good)
        return palp_file_commit(&file, false, error);
    cli_failure(NAME, "%s: cannot write: %s", out,
                *file.temporary ? strerror(errno) : "it is no regular file");
    palp_file_abandon(&file);
    return PALP_ERR_FILE;
}

/* The mesh of the model stands beside it in the archive. */
static palp_status take_mesh(palp_model *model, palp_mesh_source *source, part *mesh, palp_error *error) {
    char path[2 * PALP_PATH_MAX];
    if (model->kind != PALP_MODEL_NETWORK || source->kind != PALP_MESH_FILE)
        return PALP_OK;
    snprintf(path, sizeof path, "%s%s%s", *source->path == '/' ? "" : source->folder,
             *source->path == '/' || !*source->folder ? "" : "/", source->path);
    strcpy(source->path, "mesh.msh");
    mesh->name = "resources/mesh.msh";
    return palp_file_read(path, &mesh->bytes, &mesh->n, error);
}

static char *copy(const char *text) {
    char *to = malloc(strlen(text) + 1);
    return to ? strcpy(to, text) : NULL;
}

/* The parts of the archive; on failure those made so far, which the caller frees. */
static palp_status make_parts(const char *program, palp_model *model, palp_mesh_source *source,
                              const double top_m[3], part parts[5], palp_error *error) {
    char token[96];
    palp_status status = palp_file_read(program, &parts[0].bytes, &parts[0].n, error);
    status = status ? status : take_mesh(model, source, &parts[4], error);
    status = status ? status : palp_model_format(model, &parts[1].bytes);
    if (status)
        return status;
    uint32_t sum = crc32_add(0, parts[1].bytes, strlen(parts[1].bytes));
    sum = crc32_add(sum, parts[4].bytes, parts[4].n);
    snprintf(token, sizeof token, "palpate-%s-%08lx", palp_version(), (unsigned long)sum);
    parts[2].bytes = copy(token);
    parts[3].bytes = fmu_description(model, token, top_m);
    for (int i = 1; i < 4; i++) {
        if (!parts[i].bytes)
            return PALP_ERR_NO_MEMORY;
        parts[i].n = strlen(parts[i].bytes);
    }
    return PALP_OK;
}

static int pack(const char *program, palp_model *model, palp_mesh_source *source, const double top_m[3],
                const char *out) {
    part parts[5] = {{"binaries/" PLATFORM "/palpate.so", NULL, 0},
                     {"resources/model.json", NULL, 0},
                     {"resources/token", NULL, 0},
                     {"modelDescription.xml", NULL, 0},
                     {NULL, NULL, 0}};
    palp_error error = {PALP_OK, ""};
    palp_status status = make_parts(program, model, source, top_m, parts, &error);
    int code = status ? cli_status_of(NAME, out, status, &error) : CLI_OK;
    if (!code) {
        status = write_archive(out, parts[4].name ? 5 : 4, parts, &error);
        code = !status ? CLI_OK : *error.text ? cli_status(NAME, status, &error) : CLI_FAILURE;
    }
    for (int i = 0; i < 5; i++)
        free(parts[i].bytes);
    return code;
}

/* Effects of the instrument are left out, as the FMU gives the force on the plate itself. */
static int leave_effects(const char *file, palp_model *model) {
    for (size_t i = 0; i < model->n_effects; i++) {
        const palp_effect_info *info = palp_effect_look_up(model->effects[i].id);
        if (info->place == PALP_EFFECT_SPECIMEN || info->place == PALP_EFFECT_CONTACT)
            return cli_failure(NAME,
                               "%s: its effect %s is of the specimen or contact, which an FMU does not have",
                               file, info->id);
    }
    if (model->n_effects > 0)
        cli_warning(NAME, "%s: effects of the instrument are left out", file);
    if (model->n_free > 0)
        cli_warning(NAME, "%s: its free terms are left out", file);
    model->n_effects = model->n_free = 0;
    return CLI_OK;
}

/* Whether the FMU will be able to make the network; top_m: the middle of its top. */
static int try_network(const palp_model *model, double top_m[3]) {
    palp_network *network = NULL;
    palp_error error = {PALP_OK, ""};
    double low[3], high[3];
    if (model->kind == PALP_MODEL_LUMPED)
        return CLI_OK;
    palp_status status = palp_network_from_model(model, NULL, 0, NULL, NULL, &network, &error);
    if (status)
        return cli_status(NAME, status, &error);
    palp_mesh_bounds(palp_network_mesh(network), low, high);
    for (int k = 0; k < 3; k++)
        top_m[k] = k == 1 ? high[k] : 0.5 * (low[k] + high[k]);
    palp_network_free(network);
    return CLI_OK;
}

int export_fmu(const char *model_file, const char *out) {
    char program[CLI_PATH_MAX];
    double top_m[3] = {0, 0, 0};
    palp_model model;
    palp_mesh_source *source = malloc(sizeof *source);
    int code = source ? CLI_OK : cli_failure(NAME, "out of memory");
    if (!out)
        code = cli_usage_error(NAME, "name the FMU by --out MODEL.fmu");
    code = code ? code : open_model(NAME, model_file, &model, source);
    code = code ? code : leave_effects(model_file, &model);
    code = code ? code : try_network(&model, top_m);
    if (!code && !beside_command("palpate-fmu.so", program))
        code = cli_failure(NAME, "there is no palpate-fmu.so beside the command or in ../lib/palpate/");
    code = code ? code : pack(program, &model, source, top_m, out);
    free(source);
    return code;
}
#else
int export_fmu(const char *model_file, const char *out) {
    (void)out;
    return cli_failure(
        NAME, "%s: this palpate was built without minizip; install libminizip-dev and build it again",
        model_file);
}
#endif
