/* The files that a command reads and writes: no output takes the place of one that is read, or of another output. */
#ifndef FILES_H
#define FILES_H

/* For main to call first: files that the library opens are known then. */
void files_begin(void);

/* What the command was given to read, as far as it knows the names, and what it writes; - is standard input or standard
   output, null is nothing. None has to be there. */
void files_read(const char *name);
void files_write(const char *name);

/* What to do where an output is a file that the command was given to read. */
enum files_force { FILES_REFUSE, FILES_REFUSE_UNFORCED, FILES_FORCED };

/* Returns 0; or prints which output is not to be, and returns the exit status. FILES_REFUSE_UNFORCED names --force too.
   What belongs to a file that is read, as the pictures of an .sog folder, is never replaced. */
int files_check(enum files_force force);

#endif
