/* export_fmu.h: a model as an FMU: FMI 3.0, co-simulation, with the library inside. */
#ifndef PALPATE_EXPORT_FMU_H
#define PALPATE_EXPORT_FMU_H

/* Writes the FMU of a lumped or network model. An exit code, after one line on stderr if it is not 0. */
int export_fmu(const char *model_file, const char *out);

#endif
