/* petsc_save.c: the state of a network in parts, in one file in the order of the whole mesh. Any number of
 * processes can read it. PETSc's binary format. */
#include "petsc_internal.h"

#include "base/file.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { FORMAT = 1, NUMBERS = 12, VECTOR_HEADER = 8 };

/* ---- whose state it is --------------------------------------------------------------------------- */

/* Distinguishes networks by mesh, supports and material; the same for any number of processes. */
static double fingerprint(const part *p, const palp_network *net) {
    const double volume[] = {net->settings.volume_modulus_Pa, net->settings.poisson_ratio};
    uint64_t sum = network_sum_of_material(NETWORK_SUM, &net->material), nodes = 0;
    sum = network_sum(sum, volume, sizeof volume);
    if (net->settings.edge_correction)
        sum = network_sum(sum, "edges", 5);
    for (size_t i = 0; i < p->n_nodes; i++)
        if (p->own[i]) {
            uint64_t one = network_sum(NETWORK_SUM, &p->node[i], sizeof p->node[i]);
            one = network_sum(one, net->rest + 3 * i, 3 * sizeof *net->rest);
            nodes += network_sum(one, net->motion + 3 * i, 3 * sizeof *net->motion);
        }
    MPI_Allreduce(MPI_IN_PLACE, &nodes, 1, MPI_UINT64_T, MPI_SUM, p->comm);
    sum = network_sum(sum, &nodes, sizeof nodes);
    return (double)(sum >> 12); /* exact as a double */
}

/* A pass over the state: its numbers, and its arrays by node and by element. */
typedef struct pass {
    part *p;
    palp_network *net;
    PetscViewer file;
    bool save;
    PetscInt *place; /* [the longer of 3 n_nodes and n_elements] of a value in the whole array */
    double *kept;    /* as long: the values of this process */
} pass;

static PetscErrorCode pass_numbers(pass *s, double n[NUMBERS]) {
    if (s->save)
        return PetscViewerBinaryWrite(s->file, n, NUMBERS, PETSC_DOUBLE);
    return PetscViewerBinaryRead(s->file, n, NUMBERS, NULL, PETSC_DOUBLE);
}

static void collect_numbers(const pass *s, double mark, double elements, double n_more, double n[NUMBERS]) {
    const palp_network *net = s->net;
    const double all[NUMBERS] = {FORMAT,
                                 mark,
                                 elements,
                                 n_more,
                                 net->now.depth,
                                 net->now.time,
                                 net->now.force,
                                 (double)net->n_past,
                                 net->past_depth[0],
                                 net->past_time[0],
                                 net->past_depth[1],
                                 net->past_time[1]};
    memcpy(n, all, sizeof all);
}

static void take_numbers(palp_network *net, const double n[NUMBERS]) {
    net->now.depth = n[4];
    net->now.time = n[5];
    net->now.force = n[6];
    net->n_past = (size_t)n[7];
    net->past_depth[0] = n[8];
    net->past_time[0] = n[9];
    net->past_depth[1] = n[10];
    net->past_time[1] = n[11];
}

/* ---- arrays -------------------------------------------------------------------------------------- */

/* values[n] of which value i stands at place[i] in the whole array; saved are the first n_kept of kept. */
static PetscErrorCode pass_array(pass *s, PetscInt whole, PetscInt n, PetscInt n_kept, double *values) {
    Vec all, mine;
    PASS(VecCreateMPI(s->p->comm, PETSC_DECIDE, whole, &all));
    if (s->save) {
        PASS(VecSetValues(all, n_kept, s->place, s->kept, INSERT_VALUES));
        PASS(VecAssemblyBegin(all));
        PASS(VecAssemblyEnd(all));
        PASS(VecView(all, s->file));
        return VecDestroy(&all);
    }
    IS from;
    VecScatter scatter;
    PASS(VecLoad(all, s->file));
    PASS(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, values, &mine));
    PASS(ISCreateGeneral(s->p->comm, n, s->place, PETSC_USE_POINTER, &from));
    PASS(VecScatterCreate(all, from, mine, NULL, &scatter));
    PASS(VecScatterBegin(scatter, all, mine, INSERT_VALUES, SCATTER_FORWARD));
    PASS(VecScatterEnd(scatter, all, mine, INSERT_VALUES, SCATTER_FORWARD));
    PASS(VecScatterDestroy(&scatter));
    PASS(ISDestroy(&from));
    PASS(VecDestroy(&mine));
    return VecDestroy(&all);
}

/* values[3 n_nodes]. */
static PetscErrorCode pass_nodes(pass *s, PetscInt n_whole, double *values) {
    const part *p = s->p;
    PetscInt n = 0;
    for (size_t i = 0; i < 3 * p->n_nodes; i++)
        if (!s->save || p->own[i / 3]) {
            s->kept[n] = values[i];
            s->place[n++] = 3 * p->node[i / 3] + (PetscInt)(i % 3);
        }
    return pass_array(s, 3 * n_whole, n, n, values);
}

/* values[n_elements]. */
static PetscErrorCode pass_elements(pass *s, PetscInt n_whole, double *values) {
    const PetscInt n = (PetscInt)s->net->n_elements;
    for (PetscInt i = 0; i < n; i++) {
        s->kept[i] = values[i];
        s->place[i] = s->p->element[i];
    }
    return pass_array(s, n_whole, n, n, values);
}

static PetscErrorCode pass_arrays(pass *s, PetscInt nodes, PetscInt elements) {
    palp_network *net = s->net;
    network_state *now = &net->now;
    double *by_node[] = {now->x, now->inner, net->past[0], net->past[1]};
    for (size_t i = 0; i < sizeof by_node / sizeof *by_node; i++)
        PASS(pass_nodes(s, nodes, by_node[i]));
    PASS(pass_elements(s, elements, now->element));
    PASS(pass_elements(s, elements, now->history.strain));
    if (now->history.elastic)
        PASS(pass_elements(s, elements, now->history.elastic));
    for (size_t j = 0; j < net->material.n_arms; j++)
        PASS(pass_elements(s, elements, now->history.arm + j * now->history.stride));
    return 0;
}

/* Bytes of the file, if n_more numbers of the caller are in it. */
static double bytes_of_state(const palp_network *net, double nodes, double elements, double n_more) {
    const double by_element = 2.0 + (net->now.history.elastic != NULL) + (double)net->material.n_arms;
    return 8.0 * (NUMBERS + n_more) + 4.0 * (VECTOR_HEADER + 24.0 * nodes) +
           by_element * (VECTOR_HEADER + 8.0 * elements);
}

/* ---- the file ------------------------------------------------------------------------------------ */

static palp_status begin_pass(pass *s, palp_network *net, bool save) {
    const size_t n = 3 * net->n_nodes > net->n_elements ? 3 * net->n_nodes : net->n_elements;
    *s = (pass){.p = (part *)net->ranks, .net = net, .save = save};
    s->place = malloc((n + 1) * sizeof *s->place);
    s->kept = malloc((n + 1) * sizeof *s->kept);
    return s->place && s->kept ? PALP_OK : PALP_ERR_NO_MEMORY;
}

static void end_pass(pass *s) {
    PetscViewerDestroy(&s->file);
    free(s->place);
    free(s->kept);
}

/* Counts nodes and elements of the whole network. */
static void count_whole(const part *p, const palp_network *net, PetscInt *nodes, PetscInt *elements) {
    double n[2] = {(double)p->n_own, (double)net->n_elements};
    MPI_Allreduce(MPI_IN_PLACE, n, 2, MPI_DOUBLE, MPI_SUM, p->comm);
    *nodes = (PetscInt)n[0];
    *elements = (PetscInt)n[1];
}

static PetscErrorCode write_state(pass *s, const char *path, size_t n_more, const double *more) {
    PetscInt nodes, elements;
    double n[NUMBERS];
    count_whole(s->p, s->net, &nodes, &elements);
    PASS(PetscViewerBinaryOpen(s->p->comm, path, FILE_MODE_WRITE, &s->file));
    PASS(PetscViewerBinarySetSkipInfo(s->file, PETSC_TRUE));
    collect_numbers(s, fingerprint(s->p, s->net), elements, (double)n_more, n);
    PASS(pass_numbers(s, n));
    PASS(PetscViewerBinaryWrite(s->file, more, (PetscInt)n_more, PETSC_DOUBLE));
    PASS(pass_arrays(s, nodes, elements));
    return PetscViewerDestroy(&s->file);
}

/* Are the arrays that are saved here all of its state? */
static bool can_be_saved(const palp_network *net) {
    bool stateless = !net->now.vector && !net->now.history.peak;
    for (size_t i = 0; i < net->n_terms; i++)
        stateless = stateless && !net->terms[i]->kind->pass;
    return stateless;
}

/* Asks the first process, which alone opens files, whether it can. Otherwise PETSc would leave the others
 * waiting. Bytes of the file, or -1. */
static double ask_for_file(const part *p, const char *path, bool create) {
    double bytes = -1.0;
    if (p->hook.rank == 0) {
        struct stat info;
        FILE *f = fopen(path, create ? "wb" : "rb");
        if (f && stat(path, &info) == 0 && S_ISREG(info.st_mode))
            bytes = (double)info.st_size;
        if (f)
            fclose(f);
    }
    MPI_Bcast(&bytes, 1, MPI_DOUBLE, 0, p->comm);
    return bytes;
}

/* The file has a temporary name until it is whole. */
palp_status palp_ranks_save(const palp_network *network, const char *path, size_t n, const double *more,
                            palp_error *error) {
    if (!network || !path || (n > 0 && !more))
        return palp_error_null(error);
    palp_network *net = (palp_network *)network; /* saving only reads */
    if (!net->ranks || !can_be_saved(net))
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "%s: only a network in parts without tools can be saved so", path);
    const MPI_Comm comm = ((part *)net->ranks)->comm;
    char part_path[PALP_PATH_MAX];
    if ((size_t)snprintf(part_path, sizeof part_path, "%s.part", path) >= sizeof part_path)
        return palp_error_set(error, PALP_ERR_LIMIT, "%s: too long a name", path);
    pass s;
    palp_status status = begin_pass(&s, net, true);
    status = part_agree(comm, status, NULL);
    if (!status && ask_for_file(s.p, part_path, true) < 0.0)
        status = PALP_ERR_FILE;
    if (!status && write_state(&s, part_path, n, more)) {
        if (net->ranks->count > 1)
            MPI_Abort(comm, 1); /* the others wait for this process, whose disk is full */
        status = PALP_ERR_FILE;
    }
    end_pass(&s);
    if (!status && net->ranks->rank == 0 && rename(part_path, path) != 0)
        status = PALP_ERR_FILE;
    status = part_agree(comm, status, NULL);
    return status == PALP_ERR_FILE ? palp_error_set(error, status, "%s: cannot be written", path)
           : status                ? palp_error_set(error, status, "%s: %s", path, palp_status_text(status))
                                   : PALP_OK;
}

static palp_status read_state(pass *s, const char *path, size_t *n, double **more, palp_error *error) {
    PetscInt nodes, elements;
    double found[NUMBERS], own[NUMBERS];
    count_whole(s->p, s->net, &nodes, &elements);
    collect_numbers(s, fingerprint(s->p, s->net), elements, 0.0, own);
    const double bytes = ask_for_file(s->p, path, false);
    if (bytes < 0.0)
        return palp_error_set(error, PALP_ERR_FILE, "%s: cannot be opened", path);
    if (bytes < 8.0 * NUMBERS || PetscViewerBinaryOpen(s->p->comm, path, FILE_MODE_READ, &s->file) ||
        pass_numbers(s, found) || found[0] != FORMAT || !(found[3] >= 0.0 && found[3] < 1e9))
        return palp_error_set(error, PALP_ERR_INPUT, "%s: is no saved state of a network in parts", path);
    if (found[1] != own[1] || found[2] != own[2])
        return palp_error_set(error, PALP_ERR_INPUT, "%s: is the state of another network", path);
    if (bytes != bytes_of_state(s->net, nodes, elements, found[3]))
        return palp_error_set(error, PALP_ERR_INPUT, "%s: is cut short", path);
    *n = (size_t)found[3];
    *more = malloc((*n + 1) * sizeof **more);
    if (part_agree(s->p->comm, *more ? PALP_OK : PALP_ERR_NO_MEMORY, NULL))
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "%s: out of memory", path);
    if (PetscViewerBinaryRead(s->file, *more, (PetscInt)*n, NULL, PETSC_DOUBLE) ||
        pass_arrays(s, nodes, elements))
        return palp_error_set(error, PALP_ERR_INPUT, "%s: cannot be read", path);
    take_numbers(s->net, found);
    return PALP_OK;
}

palp_status palp_ranks_restore(palp_network *net, const char *path, size_t *n, double **more,
                               palp_error *error) {
    if (!net || !path || !n || !more)
        return palp_error_null(error);
    *n = 0;
    *more = NULL;
    if (!net->ranks || !can_be_saved(net))
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "%s: only a network in parts without tools can be restored so", path);
    pass s;
    palp_status status = begin_pass(&s, net, false);
    status = part_agree(((part *)net->ranks)->comm, status, error);
    net->trial = net->factored = net->exact = false;
    if (!status)
        status = read_state(&s, path, n, more, error);
    end_pass(&s);
    if (status) {
        free(*more);
        *more = NULL;
        palp_network_reset(net);
    }
    return status;
}
