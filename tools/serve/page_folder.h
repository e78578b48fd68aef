/* Finds the folder of the npm package, which contains the viewer's page. */
#ifndef PAGE_FOLDER_H
#define PAGE_FOLDER_H

enum { PAGE_PATH = 4096 };

/* Finds the folder of the npm package. Uses environment variable FIXSPLAT_WEB if set, otherwise looks near the
   program. */
int page_folder_find(char folder[PAGE_PATH]);

/* Finds the folder of the npm package like page_folder_find, but prints nothing. Returns 1 if found, else 0. */
int page_folder_look(char folder[PAGE_PATH]);

#endif
