/* temporary.h: removes temporary files and folders when a signal ends the command. */
#ifndef PALPATE_TEMPORARY_H
#define PALPATE_TEMPORARY_H

#include "cli.h"

/* From now on SIGINT, SIGTERM and SIGHUP, unless the command catches them itself, remove this process'
 * temporary files from the folder of path, an output; "DIR/" is the folder itself. */
void temporary_tidy_on_signal(const char *path);

/* A new folder in TMPDIR; remove it and the files in it by temporary_folder_remove. Signals do so, too. */
int temporary_folder_make(const char *command, char folder[CLI_PATH_MAX]);
void temporary_folder_remove(const char *folder);

#endif
