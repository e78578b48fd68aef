/* The header of a .ply file with any elements. */
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
    double full;               /* full brightness of a colour */
} fxs_ply_type;

extern const fxs_ply_type fxs_ply_types[FXS_PLY_TYPES];

typedef struct fxs_ply_property {
    char name[FXS_PLY_MAX_NAME + 1];   /* cut to fit */
    uint8_t type;
    uint8_t is_list, count_type;
    uint32_t offset;           /* bytes from the start of a binary row, with empty lists */
} fxs_ply_property;

typedef struct fxs_ply_element {
    char name[FXS_PLY_MAX_NAME + 1];   /* cut to fit */
    uint64_t count;
    int first, end;            /* properties */
    int has_lists;
    uint32_t row_size;         /* bytes of a binary row, with empty lists */
} fxs_ply_element;

typedef struct fxs_ply_header {
    fxs_ply_encoding encoding;
    int antialiased;
    int elements, properties;
    fxs_ply_element element_table[FXS_PLY_MAX_ELEMENTS];
    fxs_ply_property property_table[FXS_PLY_MAX_PROPERTIES];
} fxs_ply_header;

/* Reads the header of a file into *header, which must be 0. Returns 0, or an error and a message. */
int fxs_ply_read_header(fxs_ply_header *header, fxs_byte_reader *bytes, fxs_message *message);

/* Checks the file's size against the counts of the header just read. Returns 0, or an error and a message. */
int fxs_ply_check_size(const fxs_ply_header *header, const fxs_byte_reader *bytes, fxs_message *message);

/* The element of that name, or NULL. */
const fxs_ply_element *fxs_ply_find_element(const fxs_ply_header *header, const char *name);

/* The index of a property that is no list, or -1. */
int fxs_ply_find(const fxs_ply_header *header, const fxs_ply_element *element, const char *name);

/* Finds SH coefficients, f_rest_*, which are channel-major in a file. Returns their degree, 0 to 4, with the index of
   coefficient k of a channel in rest[3 * k + channel], or an error and a message that starts with `path`. */
int fxs_ply_find_rest(const fxs_ply_header *header, const fxs_ply_element *element, int rest[FXS_PLY_MAX_REST],
                      const char *path, fxs_message *message);

/* Finds a colour of three properties, under one of the names that point clouds have for it. Returns its value of full
   brightness, which is 1 for a real type, or 0 where no such colour exists. */
double fxs_ply_find_colour(const fxs_ply_header *header, const fxs_ply_element *element, int colour[3]);

/* ---- Values ---- */

double fxs_ply_load_number(const uint8_t *bytes, int type, fxs_ply_encoding encoding);

/* Reads the next value of a row. Returns 0, or FXS_ERR_FILE with a fault in the reader. */
int fxs_ply_read_number(fxs_byte_reader *bytes, fxs_ply_encoding encoding, int type, double *value);

/* Called before and after the values of a row; in a text file they skip blanks and newlines before it, and blanks and
   the newline after it. */
void fxs_ply_begin_row(fxs_byte_reader *bytes, fxs_ply_encoding encoding);
int fxs_ply_end_row(fxs_byte_reader *bytes, fxs_ply_encoding encoding);

#endif
