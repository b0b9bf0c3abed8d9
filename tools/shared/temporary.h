/* temporary.h: what the files that are being written leave behind when a signal ends the command. */
#ifndef PALPATE_TEMPORARY_H
#define PALPATE_TEMPORARY_H

/* From now on SIGINT, SIGTERM and SIGHUP, unless the command catches them itself, remove this process'
 * temporary files from the folder of path, an output; "DIR/" is the folder itself. */
void temporary_tidy_on_signal(const char *path);

#endif
