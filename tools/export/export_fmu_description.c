/* export_fmu_description.c: modelDescription.xml: the variables of an FMU with their units. */
#define _POSIX_C_SOURCE 200809L
#include "export_fmu_description.h"

#include <palpate/version.h>
#include <stdio.h>
#include <stdlib.h>

/* A variable, or three of them with the endings _x, _y and _z. */
typedef struct variable {
    const char *name, *causality, *variability, *unit, *about;
    int of_axes; /* 1 or 3 */
} variable;

/* In the order of the value references (fmu/fmu.h), from 1; the last five only of networks. */
static const variable variables[] = {
    {"depth", "input", "continuous", "m",
     "depth of the plate at the start of a step, positive into the tissue", 1},
    {"depth_rate", "input", "continuous", "m/s", "rate of the depth during a step", 1},
    {"force", "output", "continuous", "N",
     "force on the plate or, along y, on the sphere; positive = compression", 1},
    {"max_step", "parameter", "fixed", "s", "longest step of the model; 0 = as long as a communication step",
     1},
    {"tip_radius", "parameter", "fixed", "m", "radius of a sphere in place of the plate; 0 = the plate", 1},
    {"tool", "input", "continuous", "m",
     "centre of the sphere at the start of a step, in the mesh's coordinates", 3},
    {"tool_rate", "input", "continuous", "m/s", "velocity of the sphere during a step", 3},
    {"tool_force", "output", "continuous", "N", "force of the tissue on the sphere", 3}};
enum { LUMPED = 4, ALL = sizeof variables / sizeof variables[0] };

static const char units[] = "  <UnitDefinitions>\n"
                            "    <Unit name=\"m\"><BaseUnit m=\"1\"/></Unit>\n"
                            "    <Unit name=\"s\"><BaseUnit s=\"1\"/></Unit>\n"
                            "    <Unit name=\"m/s\"><BaseUnit m=\"1\" s=\"-1\"/></Unit>\n"
                            "    <Unit name=\"N\"><BaseUnit kg=\"1\" m=\"1\" s=\"-2\"/></Unit>\n"
                            "  </UnitDefinitions>\n";

static void print_variable(FILE *to, const variable *v, int axis, int reference, double start) {
    static const char *const endings[] = {"_x", "_y", "_z"};
    const char *ending = v->of_axes == 3 ? endings[axis] : "";
    fprintf(
        to,
        "    <Float64 name=\"%s%s\" valueReference=\"%d\" causality=\"%s\" variability=\"%s\" unit=\"%s\" ",
        v->name, ending, reference, v->causality, v->variability, v->unit);
    if (*v->causality == 'o')
        fprintf(to, "initial=\"calculated\" description=\"%s\"/>\n", v->about);
    else
        fprintf(to, "start=\"%.17g\" description=\"%s\"/>\n", start, v->about);
}

/* The sphere starts with its centre at the middle of the top. */
static void print_variables(FILE *to, size_t n, const double top[3]) {
    int reference = 1;
    fputs("  <ModelVariables>\n    <Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" "
          "variability=\"continuous\" unit=\"s\" description=\"time\"/>\n",
          to);
    for (size_t i = 0; i < n; i++)
        for (int axis = 0; axis < variables[i].of_axes; axis++)
            print_variable(to, &variables[i], axis, reference++, i == LUMPED + 1 ? top[axis] : 0);
    fputs("  </ModelVariables>\n", to);
}

static void print_outputs(FILE *to, size_t n, const char *element) {
    int reference = 1;
    for (size_t i = 0; i < n; i++)
        for (int axis = 0; axis < variables[i].of_axes; axis++, reference++)
            if (*variables[i].causality == 'o')
                fprintf(to, "    <%s valueReference=\"%d\"/>\n", element, reference);
}

char *fmu_description(const palp_model *model, const char *token, const double top_m[3]) {
    char *text = NULL;
    size_t size = 0, n = model->kind == PALP_MODEL_LUMPED ? LUMPED : ALL;
    FILE *to = open_memstream(&text, &size);
    if (!to)
        return NULL;
    fprintf(to,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<fmiModelDescription fmiVersion=\"3.0\" modelName=\"palpate %s\" instantiationToken=\"%s\"\n"
            "    description=\"A tissue model under an indenter\" generationTool=\"palpate %s\">\n"
            "  <CoSimulation modelIdentifier=\"palpate\" canHandleVariableCommunicationStepSize=\"true\"\n"
            "      canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"/>\n%s"
            "  <LogCategories>\n    <Category name=\"error\"/>\n    <Category name=\"discard\"/>\n  "
            "</LogCategories>\n"
            "  <DefaultExperiment startTime=\"0\" stopTime=\"10\" stepSize=\"0.01\"/>\n",
            model->kind == PALP_MODEL_LUMPED ? "lumped" : "network", token, palp_version(), units);
    print_variables(to, n, top_m);
    fputs("  <ModelStructure>\n", to);
    print_outputs(to, n, "Output");
    print_outputs(to, n, "InitialUnknown");
    fputs("  </ModelStructure>\n</fmiModelDescription>\n", to);
    bool good = fclose(to) == 0;
    if (!good)
        free(text);
    return good ? text : NULL;
}
