/* Where the page lies that shows scenes: the folder of the npm package. */
#ifndef PAGE_FOLDER_H
#define PAGE_FOLDER_H

enum { PAGE_PATH = 4096 };

/* Where FIXSPLAT_WEB says, else beside this program, as it is built or installed. Returns 0, or prints that it is not
   there and returns EXIT_FAILED. */
int page_folder_find(char folder[PAGE_PATH]);

/* The same without a word: whether it is there. */
int page_folder_look(char folder[PAGE_PATH]);

#endif
