/* fuzz_mesh.c: libFuzzer's harness for Gmsh files; run.sh builds and runs it. */
#include "fuzz.h"

#include <palpate/mesh.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[256];
    fuzz_file(path, ".msh", data, size);
    for (int diagonals = 0; diagonals < 2; diagonals++) {
        palp_mesh *mesh;
        if (palp_mesh_read_gmsh(path, 1e-3, diagonals, &mesh, NULL) == PALP_OK) {
            palp_mesh_free(mesh);
        }
    }
    return 0;
}
