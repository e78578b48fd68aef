/* Keeps a command's output from replacing an input or another output. */
#ifndef FILE_GUARD_H
#define FILE_GUARD_H

/* Starts to record which files the program reads and writes. Call first in main. */
void files_begin(void);

/* These functions register an input file and an output file. "-" is standard input or output; null is ignored. */
void files_read(const char *name);
void files_write(const char *name);

/* True if two file names denote the same file. */
int files_same(const char *one, const char *other);

/* Forgets the files that the library has opened to read. For work on files that are removed meanwhile: another file may
   get the identity of a removed one. */
void files_forget(void);

/* Policy for an output that is also an input: refuse (default), refuse with a hint to --force, or replace. */
enum files_force { FILES_REFUSE, FILES_REFUSE_UNFORCED, FILES_FORCED };
void files_force(enum files_force force);

int files_check(void);

/* Forgets the registered output files, so that the command may read them. */
void files_done(void);

#endif
