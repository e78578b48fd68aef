/* Reads headers and values of .ply files. Functions return 0, or an error and a message. */
#ifndef FXS_PLY_HEADER_H
#define FXS_PLY_HEADER_H

#include "src/base/byte_reader.h"

enum { FXS_PLY_MAX_ELEMENTS = 64, FXS_PLY_MAX_PROPERTIES = 1024, FXS_PLY_MAX_NAME = 39, FXS_PLY_MAX_REST = 72 };

typedef enum fxs_ply_encoding {
    FXS_PLY_NONE, FXS_PLY_ASCII, FXS_PLY_LITTLE_ENDIAN, FXS_PLY_BIG_ENDIAN
} fxs_ply_encoding;

enum {
    FXS_PLY_CHAR, FXS_PLY_UCHAR, FXS_PLY_SHORT, FXS_PLY_USHORT, FXS_PLY_INT, FXS_PLY_UINT, FXS_PLY_FLOAT,
    FXS_PLY_DOUBLE, FXS_PLY_HALF, FXS_PLY_TYPES
};

typedef struct fxs_ply_type {
    const char *name, *alias;
    uint8_t size;
    double full;               /* stored number that means full brightness if a colour has this type */
} fxs_ply_type;

extern const fxs_ply_type fxs_ply_types[FXS_PLY_TYPES];

typedef struct fxs_ply_property {
    char name[FXS_PLY_MAX_NAME + 1];
    uint8_t type;
    uint8_t is_list, count_type;
    uint32_t offset;           /* offset of the property in a binary row, in bytes */
} fxs_ply_property;

typedef struct fxs_ply_element {
    char name[FXS_PLY_MAX_NAME + 1];
    uint64_t count;
    int first, end;
    int has_lists;
    uint32_t row_size;         /* size of a binary row in bytes, if all lists are empty */
} fxs_ply_element;

/* Numbers in comments about the time of a moving scene. */
enum {
    FXS_PLY_FTGS_VERSION, FXS_PLY_USE_VELOCITY, FXS_PLY_MIN_DURATION, FXS_PLY_OPACITY_FLOOR, FXS_PLY_N_FRAMES,
    FXS_PLY_FPS, FXS_PLY_DURATION, FXS_PLY_START, FXS_PLY_SETTINGS
};

extern const char *const fxs_ply_setting_names[FXS_PLY_SETTINGS];

typedef struct fxs_ply_header {
    fxs_ply_encoding encoding;
    int antialiased;
    uint32_t given;            /* bit i: the header has setting i */
    double settings[FXS_PLY_SETTINGS];   /* NaN: no number */
    int elements, properties;
    fxs_ply_element element_table[FXS_PLY_MAX_ELEMENTS];
    fxs_ply_property property_table[FXS_PLY_MAX_PROPERTIES];
} fxs_ply_header;

/* Reads the header of a .ply file. *header must be zeroed. */
int fxs_ply_read_header(fxs_ply_header *header, fxs_byte_reader *bytes, fxs_message *message);

/* Checks that the .ply file is large enough for its element counts. Call directly after fxs_ply_read_header. */
int fxs_ply_check_size(const fxs_ply_header *header, const fxs_byte_reader *bytes, fxs_message *message);

const fxs_ply_element *fxs_ply_find_element(const fxs_ply_header *header, const char *name);

/* Returns the index of the element's property called `name`, or -1. Lists are not found. */
int fxs_ply_find(const fxs_ply_header *header, const fxs_ply_element *element, const char *name);

/* Finds the properties f_rest_*, which are the SH coefficients above degree 0. Returns the SH degree, 0 to 4, or an
   error. rest[3 * k + channel] becomes the index of the property of coefficient k. */
int fxs_ply_find_rest(const fxs_ply_header *header, const fxs_ply_element *element, int rest[FXS_PLY_MAX_REST],
                      const char *path, fxs_message *message);

/* Finds a colour stored as three properties such as red, green, blue. Returns the number that means full brightness; 0:
   no colour. */
double fxs_ply_find_colour(const fxs_ply_header *header, const fxs_ply_element *element, int colour[3]);

/* Reads a decimal number, or nan or inf, in the whole of `word`. Returns 1, or 0 if it is no number. */
int fxs_ply_parse_number(const char *word, double *value);

double fxs_ply_load_number(const uint8_t *bytes, int type, fxs_ply_encoding encoding);

/* Reads the next value of a .ply row. Returns 0, or FXS_ERR_FILE, with the fault stored in `bytes`. */
int fxs_ply_read_number(fxs_byte_reader *bytes, fxs_ply_encoding encoding, int type, double *value);

/* Begin and end a .ply row; call them before and after reading the row's values. In text files, both functions skip
   blanks and newlines. */
void fxs_ply_begin_row(fxs_byte_reader *bytes, fxs_ply_encoding encoding);
int fxs_ply_end_row(fxs_byte_reader *bytes, fxs_ply_encoding encoding);

#endif
