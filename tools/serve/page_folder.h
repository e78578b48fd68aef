/* Finds the folder of the npm package, which contains the viewer's page. */
#ifndef PAGE_FOLDER_H
#define PAGE_FOLDER_H

enum { PAGE_PATH = 4096 };

/* Looks in FIXSPLAT_WEB if set, otherwise near this program as built or installed. Returns 0, or prints that it was
   not found and returns EXIT_FAILED. */
int page_folder_find(char folder[PAGE_PATH]);

/* As page_folder_find, without messages. Returns 1 if found, else 0. */
int page_folder_look(char folder[PAGE_PATH]);

#endif
