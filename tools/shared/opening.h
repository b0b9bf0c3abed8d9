/* opening.h: models and runs as every command opens them: one line on stderr where one cannot be used. */
#ifndef PALPATE_OPENING_H
#define PALPATE_OPENING_H

#include <palpate/explain.h>
#include <palpate/model.h>

/* Functions return an exit code; command is its name for messages. mesh is as of palp_model_read. The caller
 * frees *run. */
int open_model(const char *command, const char *file, palp_model *model, palp_mesh_source *mesh);
int open_run(const char *command, const char *file, palp_experiment **run);

/* Opens n runs, one sample in every of each, and those between them where the path bends. every 0: in so many
 * that 20000 remain in all, which stderr says. They are the caller's, also those opened before an error. */
int open_runs(const char *command, size_t n, const char *const *files, size_t every, palp_experiment **run,
              palp_explain_input *input);

/* Refuses a model with a density where the networks have no mass. */
int open_refuse_mass(const char *command, const char *file, const palp_model *model);

/* Opens a model of one kind; for another the message is "file: otherwise". */
int open_model_of(const char *command, const char *file, palp_model_kind kind, const char *otherwise,
                  palp_model *model, palp_mesh_source *mesh);

/* Takes the noise off the run's recorded depth and tool position: what follows its path sees what
 * characterize and explain see. */
palp_status open_smooth_path(palp_experiment *run);

/* A text from outside as a key of a run's header, made plain (palp_text_make_plain). */
palp_status open_set_text(palp_experiment *run, const char *key, const char *text);

/* Radius of the sphere of a run, m, 0 = a plate; its place in x and z, m, NAN without one. */
int open_tip(const char *command, const char *file, const palp_experiment *run, double *radius_m,
             double place_m[2]);

/* specimen.kind if it is "none" (air) or "rigid" (a block to measure the frame); else NULL. */
const char *open_no_specimen(const palp_experiment *run);

#endif
