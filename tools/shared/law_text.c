/* law_text.c: a stiffness law as text. */
#include "law_text.h"

#include <math.h>
#include <stdio.h>

void law_text_print(const palp_law *law) {
    if (law->kind == PALP_LAW_SPLINE) {
        printf("  K(e) through");
        for (size_t i = 0; i < law->n; i++)
            printf(" (%.4g, %.5g)", law->strain[i], law->coefficients[i]);
        printf(" (strain, N)\n");
        return;
    }
    if (law->kind != PALP_LAW_POLYNOMIAL) {
        printf("  %s:", palp_law_kind_name(law->kind));
        for (size_t i = 0; i < law->n; i++)
            printf(" %.6g", law->coefficients[i]);
        printf(law->kind == PALP_LAW_OGDEN ? " (mu in Pa and alpha in turn)\n" : " Pa\n");
        return;
    }
    printf("  K(e) =");
    for (size_t i = law->n; i-- > 0;) {
        double c = law->coefficients[i];
        printf(" %s%.6g", i + 1 == law->n ? (c < 0 ? "-" : "") : (c < 0 ? "- " : "+ "), fabs(c));
        if (i > 0)
            printf(i > 1 ? " e^%zu" : " e", i);
    }
    printf(" N\n");
}
