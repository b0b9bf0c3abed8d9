/* model_make.h: the model that the tests read. */
#ifndef MODEL_MAKE_H
#define MODEL_MAKE_H

#include <palpate/model.h>

static const char sample[] =
    "{\n"
    "  \"palpate\": {\"model\": 1},\n"
    "  \"kind\": \"network\",\n"
    "  \"specimen\": {\"height_mm\": 24, \"radius_mm\": 12.1, \"kind\": \"cylinder\"},\n"
    "  \"stiffness\": {\"kind\": \"polynomial\", \"coefficients_N\": [8.18, -0.7, 47.47]},\n"
    "  \"arms\": [\n"
    "    {\"stiffness_N\": 1.5, \"viscosity_Ns\": 3, \"stiffness_per_strain\": 2.9},\n"
    "    {\"stiffness_N\": 0.5, \"viscosity_Ns\": 30, \"time_per_strain\": -0.1}],\n"
    "  \"dashpot_Ns\": 0.25,\n"
    "  \"formulation\": \"history\",\n"
    "  \"effects\": [],\n"
    "  \"mesh\": {\"kind\": \"lattice\", \"nodes\": [3, 4, 5], \"size_mm\": [24, 23.9, 24], "
    "\"neighbourhood\": 18},\n"
    "  \"density_kg_m3\": 1040,\n"
    "  \"volume_modulus_Pa\": 5000\n"
    "}\n";

static palp_mesh_source source; /* of what was read last */

static inline void is_sample(const palp_model *model) {
    static const double c_N[] = {8.18, -0.7, 47.47};
    ck_assert_int_eq(model->kind, PALP_MODEL_NETWORK);
    ck_assert_double_eq(model->height_m, 24.0 / 1000);
    ck_assert_double_eq(model->radius_m, 12.1 / 1000);
    ck_assert_str_eq(model->specimen_kind, "cylinder");
    ck_assert_int_eq(model->material.law.kind, PALP_LAW_POLYNOMIAL);
    ck_assert_uint_eq(model->material.law.n, 3);
    ck_assert_mem_eq(model->material.law.coefficients, c_N, sizeof c_N);
    ck_assert_uint_eq(model->material.n_arms, 2);
    ck_assert_double_eq(model->material.arms[0].stiffness_N, 1.5);
    ck_assert_double_eq(model->material.arms[0].viscosity_Ns, 3);
    ck_assert_double_eq(model->material.arms[0].beta, 2.9);
    ck_assert_double_eq(model->material.arms[0].gamma, 0);
    ck_assert_double_eq(model->material.arms[1].gamma, -0.1);
    ck_assert_double_eq(model->material.dashpot_Ns, 0.25);
    ck_assert(!model->material.quasi_linear);
    ck_assert_int_eq(model->material.formulation, PALP_HISTORY);
    ck_assert_int_eq(model->mesh->kind, PALP_MESH_LATTICE);
    ck_assert_uint_eq(model->mesh->nodes[0] * 100 + model->mesh->nodes[1] * 10 + model->mesh->nodes[2], 345);
    ck_assert_double_eq(model->mesh->size_m[1], 23.9 / 1000);
    ck_assert_int_eq(model->mesh->neighbourhood, PALP_NEIGHBOURS_18);
    ck_assert_double_eq(model->density_kg_m3, 1040);
}

#endif
