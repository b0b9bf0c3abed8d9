/* export_fmu_description.h: modelDescription.xml of an FMU. */
#ifndef PALPATE_EXPORT_FMU_DESCRIPTION_H
#define PALPATE_EXPORT_FMU_DESCRIPTION_H

#include <palpate/model.h>

/* The text, malloc'ed, which the caller frees; NULL: out of memory. top_m: the middle of a network's top. */
char *fmu_description(const palp_model *model, const char *token, const double top_m[3]);

#endif
