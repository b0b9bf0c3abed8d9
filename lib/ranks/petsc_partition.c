/* petsc_partition.c: which process has which node. */
#include "petsc_internal.h"

/* First of the n nodes whose rows of the graph this process gives to PETSc. */
static PetscInt first_row(size_t n, int rank, int count) {
    return (PetscInt)(n * (size_t)rank / (size_t)count);
}

/* The rows first to last of the graph of elements: neighbours ascending. PETSc frees both arrays. */
static PetscErrorCode list_neighbours(const palp_mesh *mesh, PetscInt first, PetscInt last, PetscInt **start,
                                      PetscInt **list) {
    const int32_t *pair = palp_mesh_pairs(mesh);
    const size_t n = 2 * palp_mesh_element_count(mesh);
    PetscInt *at, rows = last - first;
    PASS(PetscCalloc1((size_t)rows + 2, start));
    at = *start;
    for (size_t i = 0; i < n; i++)
        if (pair[i] >= first && pair[i] < last)
            at[pair[i] - first + 2]++;
    for (PetscInt i = 2; i < rows + 2; i++)
        at[i] += at[i - 1];
    PASS(PetscMalloc1((size_t)at[rows + 1] + 1, list));
    for (size_t i = 0; i < n; i++)
        if (pair[i] >= first && pair[i] < last)
            (*list)[at[pair[i] - first + 1]++] = pair[i ^ 1];
    for (PetscInt i = 0; i < rows; i++)
        PASS(PetscSortInt(at[i + 1] - at[i], *list + at[i]));
    return 0;
}

/* The owners of all nodes, from those of this process' rows. */
static PetscErrorCode gather_owners(IS mine, size_t n, int32_t *owner) {
    const PetscInt *value;
    IS all;
    PASS(ISAllGather(mine, &all));
    PASS(ISGetIndices(all, &value));
    for (size_t i = 0; i < n; i++)
        owner[i] = (int32_t)value[i];
    PASS(ISRestoreIndices(all, &value));
    return ISDestroy(&all);
}

PetscErrorCode partition_nodes(const palp_ranks *ranks, const palp_mesh *mesh, int32_t *owner) {
    const size_t n = palp_mesh_node_count(mesh);
    const PetscInt first = first_row(n, ranks->rank, ranks->count),
                   last = first_row(n, ranks->rank + 1, ranks->count);
    PetscInt *start, *list;
    MatPartitioning partitioning;
    Mat graph;
    IS owners;
    for (size_t i = 0; i < n; i++)
        owner[i] = 0;
    if (ranks->count == 1)
        return 0;
    PASS(list_neighbours(mesh, first, last, &start, &list));
    PASS(MatCreateMPIAdj(ranks->comm, last - first, (PetscInt)n, start, list, NULL, &graph));
    PASS(MatPartitioningCreate(ranks->comm, &partitioning));
    PASS(MatPartitioningSetAdjacency(partitioning, graph));
    PASS(MatPartitioningSetFromOptions(partitioning));
    PASS(MatPartitioningApply(partitioning, &owners));
    PASS(gather_owners(owners, n, owner));
    PASS(ISDestroy(&owners));
    PASS(MatPartitioningDestroy(&partitioning));
    return MatDestroy(&graph);
}

PetscErrorCode number_nodes(const int32_t *owner, size_t n, int count, PetscInt *number) {
    PetscInt *next;
    PASS(PetscCalloc1((size_t)count + 1, &next));
    for (size_t i = 0; i < n; i++)
        next[owner[i] + 1]++;
    for (int r = 0; r < count; r++)
        next[r + 1] += next[r];
    for (size_t i = 0; i < n; i++)
        number[i] = next[owner[i]]++;
    return PetscFree(next);
}
