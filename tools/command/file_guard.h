/* The files that a command reads and writes. An output must not replace a file that is read, or another output.
   Commands register their files, so that conflicts show before the work begins. Unregistered files are checked when
   the library opens them. */
#ifndef FILE_GUARD_H
#define FILE_GUARD_H

/* Call first in main. From then on, files opened by the library are recorded and each output is checked. */
void files_begin(void);

/* Register files that the command reads or writes, as far as it knows them. "-" is standard input or output, null is
   ignored. The files need not exist. */
void files_read(const char *name);
void files_write(const char *name);

/* True if the names of an input and an output denote the same file. */
int files_same(const char *one, const char *other);

/* Policy for an output that is an input of the command: refuse (default), refuse with a hint to --force, or replace.
   A file that belongs to an input, such as a picture of an .sog folder, is never replaced. */
enum files_force { FILES_REFUSE, FILES_REFUSE_UNFORCED, FILES_FORCED };
void files_force(enum files_force force);

/* Returns 0, or prints the refused output and returns the exit status. */
int files_check(void);

/* Forgets the registered outputs, which now exist, so that they can be read. */
void files_done(void);

#endif
