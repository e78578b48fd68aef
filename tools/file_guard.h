/* The files that a command reads and writes: no output takes the place of one that is read, or of another output.
   Commands tell which these are, so that they are checked before the work begins. Whatever is not told, such as a file
   that is named on the way, is checked when it is begun: the library asks before each output. */
#ifndef FILE_GUARD_H
#define FILE_GUARD_H

/* For main to call first: files that the library opens are known then, and each output is checked. */
void files_begin(void);

/* Names of files that the command was given to read, as far as it knows them, and of files that it writes; - is
   standard input or output, null is nothing. None has to be there. */
void files_read(const char *name);
void files_write(const char *name);

/* Whether two names, of an input and of an output, are of one file. */
int files_same(const char *one, const char *other);

/* Where an output is a file that the command was given to read, it is refused (the default), refused by a message that
   names --force, or replaced. A file that only belongs to such a file, as a picture of an .sog folder, is never
   replaced. */
enum files_force { FILES_REFUSE, FILES_REFUSE_UNFORCED, FILES_FORCED };
void files_force(enum files_force force);

/* Returns 0, or prints which output is refused and returns the exit status. */
int files_check(void);

/* Forgets the outputs that were told: they are there now. In the place of such a file another may be, which is read. */
void files_done(void);

#endif
