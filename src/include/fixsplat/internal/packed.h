/* The packed scene: the layout of a scene that the renderer reads in place, in memory or from a mapped .fxs file. All
 * numbers are little-endian, and the scene is aligned to 64 bytes. docs/format.md specifies every byte.
 *
 *   fxs_packed_header                      192 bytes
 *   fxs_chunk[chunk_count]                 128 bytes per chunk of 256 Gaussians: origin and steps of its codes
 *   int8_t palette[stages][entries][48]    SH palette, 0 to 6 stages: 16 coefficients of each channel, the last
 *                                          of each 0; zeros pad the palette to a multiple of 64 bytes
 *   rows[chunk_count]                      the Gaussians' codes, chunk_bytes per chunk; version 5 ends here
 *
 * Version 6 adds a level-of-detail tree. The chunks above, 2 or more, are the tree's leaves.
 *
 *   fxs_tree_header                        64 bytes
 *   fxs_node[chunk_count - 1]              16 bytes per node, root first; zeros pad the nodes to a multiple of 64 bytes
 *   fxs_chunk[chunk_count - 1]             each node's chunk of coarse Gaussians, which replace all leaves below it
 *   rows[chunk_count - 1]                  the codes of the nodes' chunks
 *
 * Version 7 is a moving scene without a tree, version 8 one with a tree. Behind the palette, before the rows, it has:
 *
 *   fxs_motion_header                      64 bytes
 *   fxs_chunk_motion[chunks]               16 bytes per chunk, when the chunk is drawn; in version 8, those of the
 *                                          nodes' chunks follow the leaves'; zeros pad to a multiple of 64
 *
 * and a chunk's rows continue, behind the SH, with the rows of its motion (fxs_motion_bytes), below.
 *
 * Rows of a chunk, by profile:
 *
 *   default
 *       uint16_t x[256], y[256], z[256]    position codes
 *       uint32_t rotation[256]             rotation word: X and Y of the first axis, then the roll about the first axis
 *       uint32_t scale[256]                scale codes: first axis in bits 9..0, second in 19..10, half of the third in
 *                                          28..20; lowest bits of r, g, b in 29, 30, 31
 *       uint32_t colour[256]               upper 8 bits of r in bits 7..0, of g in 15..8, of b in 23..16; opacity in
 *                                          31..24
 *       int8_t   sh[3 * K][256]            K = 0, 3, 8, 15 for degree 0..3; row 3 * k + channel
 *
 *   compact: as default, except
 *       uint8_t  sh[256][8, 13 or 21]      degree 1, 2, 3: three signed palette indices, a gain, then 3 K codes of 3
 *                                          bits, two's complement, red first, low bits of a byte first
 *
 *   small: shorter codes. Repeated high bits extend each code to its length in profile default.
 *       uint32_t a[256]                    x in bits 10..0, y in 21..11, opacity in 31..24
 *       uint32_t b[256]                    z in bits 10..0, r in 17..11, g in 24..18, b in 30..25
 *       uint32_t c[256]                    scale codes: first axis in bits 6..0, second in 13..7, third in 19..14;
 *                                          bits 31..20 of the rotation word in the same bits
 *       uint8_t  d[256]                    bits 19..12 of the rotation word; bits 11..10 are in 23..22 of a, bit 9 in
 *                                          bit 31 of b, the rest is 0
 *       uint8_t  sh[256][4 or 6]           4 signed palette indices for degree 1, 6 for degrees 2 and 3
 *
 *   motion, in versions 7 and 8, with degree 0 to 3 of the motion header:
 *       int16_t  drift[degree][3][256]     coefficients of u, u^2, u^3 of the position codes x, y, z
 *       int16_t  turn[4][256]              with FXS_MOTION_TURNS: coefficients of u of the quaternion w, x, y, z, Q14
 *       int16_t  centre[256]               with FXS_MOTION_FADES: u of the largest opacity, Q13
 *       uint16_t width[256]                with FXS_MOTION_FADES: log2 of the width of the fade in u, plus 8, Q12
 *
 *   Signed palette index: entry in bits 6..0; bit 7 negates the entry.
 *
 * A row has 256 numbers, so a vector loads 16, 32 or 64 neighbours at once. Chunks are the leaves of a k-d tree. Chunks
 * near the viewer are small in space. An empty slot has code 0 everywhere except in SH; a Gaussian never has both
 * rotation word 0 and opacity 0. The slots after the last Gaussian are empty. Empty slots before the last Gaussian are
 * holes, from chunks with few Gaussians far out. */
#ifndef FXS_PACKED_H
#define FXS_PACKED_H

#include <stdint.h>

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_CHUNK 256
#define FXS_PACKED_MAGIC 0x31535846u      /* first four bytes of a packed scene, "FXS1" */
#define FXS_PACKED_VERSION 5u             /* file version of scenes without a level-of-detail tree */
#define FXS_PACKED_VERSION_TREE 6u        /* file version of scenes with a level-of-detail tree */
#define FXS_PACKED_VERSION_MOTION 7u      /* file version of moving scenes without a level-of-detail tree */
#define FXS_PACKED_VERSION_MOTION_TREE 8u /* file version of moving scenes with a level-of-detail tree */
#define FXS_PACKED_ANTIALIASED 1u
#define FXS_PACKED_UP 0x80000000u       /* header flag: the lower bits of `flags` store the up vector
                                           (docs/format.md) */

typedef struct fxs_packed_header {   /* the header of a packed scene has 192 bytes */
    uint32_t magic, version;
    uint32_t count, chunk_count;     /* `count` is the number of slots up to the last Gaussian, including empty slots */
    uint32_t chunk_bytes;            /* size of the rows (Gaussian codes) of a chunk, bytes */
    uint32_t sh_degree;
    uint32_t flags;                  /* FXS_PACKED_ANTIALIASED, FXS_PACKED_UP */
    uint32_t checksum;               /* in a file: CRC-32 of the header with checksum 0; in memory: 0 */
    int64_t low_q32[3], high_q32[3];               /* bounds of the Gaussians' centres; unused by the renderer */
    int64_t inner_low_q32[3], inner_high_q32[3];   /* bounds of the visible part of the scene, for framing a view:
                                                      docs/format.md */
    uint32_t profile;
    uint32_t palette_entries;        /* number of SH palette entries per stage, 1 to 128; 0: no palette */
    uint32_t palette_step_q19;       /* scale of the SH palette: coefficient = number * step; at most 32767 */
    uint32_t palette_checksum;       /* in a file: CRC-32 of the SH palette and the motion */
    uint32_t holes;                  /* number of empty slots before the last Gaussian */
    uint32_t start_tangent_q24;      /* start view: tangent of half the vertical field of view; 0: none */
    int64_t start_q32[3];            /* start view: camera centre */
    int32_t start_rotation_q30[4];   /* start view: unit quaternion w, x, y, z, world to camera */
} fxs_packed_header;

#define FXS_COLOUR_MOST 511        /* largest code of a Gaussian's base colour */

/* Opacity laws: how a chunk's opacity codes c are decoded. Law 0: c / 255. Laws 1 to 3: 1/255 + (4^(1 - law) - 1/255)
   ((c - 1) / 254)^2 for c > 0, and 0 for c = 0. Higher laws give finer steps for chunks of faint Gaussians. */
#define FXS_OPACITY_LAWS 4u

typedef struct fxs_chunk {           /* the header of a chunk has 128 bytes */
    int64_t origin_q32[3];           /* decodes positions: origin + (code * step << step_shift), within +-2^28 units */
    uint32_t step_q32[3];
    int32_t scale_q16;               /* decodes sizes: log2(sigma) = scale - code^2 * scale_step, within +-32 */
    int32_t colour_q16[3];
    uint32_t colour_step_q20[3];     /* decodes base colours: 0.5 + C0 dc = colour + code * colour_step, within +-64,
                                        where C0 is the SH constant of degree 0 */
    uint32_t checksum;               /* in a file: CRC-32 of the chunk header with checksum 0, and of its rows */
    uint16_t sh_step_q19[3];         /* decodes SH in profile default: coefficient of degree d = code * sh_step[d -
                                        1] */
    uint16_t step_shift;             /* left shift of position codes, 0 to 12 bits */
    uint16_t scale_step_q24;         /* step of size codes, at most 1026 */
    uint16_t opacity_law;            /* number of the opacity law, 0 to 3 */
    int8_t sh_mean[48];              /* for profiles compact and small: mean SH of the chunk, added to each Gaussian's
                                        SH */
} fxs_chunk;

#define FXS_TREE_MAGIC 0x54535846u        /* first four bytes of a level-of-detail tree, "FXST" */

typedef struct fxs_tree_header {     /* the header of a level-of-detail tree has 64 bytes */
    uint32_t magic;
    uint32_t node_count;             /* number of tree nodes, chunk_count - 1 */
    uint32_t checksum;               /* in a file: CRC-32 of the tree header with checksum 0, nodes and padding */
    uint32_t reserved[13];           /* reserved bytes, which must be 0 */
} fxs_tree_header;

/* A node of the level-of-detail tree. The node's chunk of coarse Gaussians replaces both children's chunks. Leaves
   have the chunk numbers from 0 on; node i has number chunk_count + i. A node comes before its children. */
typedef struct fxs_node {            /* a node of the level-of-detail tree has 16 bytes */
    uint32_t children[2];            /* chunk numbers of the node's two children */
    int16_t gain_q8;                 /* log2 of the squared error that drawing the children removes, in colours^2
                                        units^2 */
    int16_t size_q8;                 /* log2 of the size (sigma) of the differences between the node and its children,
                                        in units */
    int16_t area_q8;                 /* log2 of the mean visible area sigma^2 of the node's Gaussians, in units^2 */
    uint16_t swell_q8;               /* log2 of a ratio: the opacity sum of all leaves below, each opacity 1/255.5 or
                                        more, over the node's own sum */
} fxs_node;

#define FXS_SWELL_MOST_Q8 (32 << 8)

#define FXS_MOTION_MAGIC 0x4d535846u      /* first four bytes of the motion of a scene, "FXSM" */
#define FXS_MOTION_LOOPS 1u               /* flags of a motion header: the scene starts again after its duration */
#define FXS_MOTION_TURNS 2u               /* its Gaussians turn: they have the rows `turn` */
#define FXS_MOTION_FADES 4u               /* its Gaussians fade in and out: they have the rows `centre` and `width` */
#define FXS_MOTION_DEGREE 3u              /* largest degree of the polynomials of the position */
#define FXS_MOTION_DURATION_MOST (1u << 30)   /* 4.5 hours */

typedef struct fxs_motion_header {   /* the header of a scene's motion has 64 bytes */
    uint32_t magic;
    uint32_t duration_q16;           /* seconds, above 0; times are 0 to the duration */
    uint32_t rate_q16;               /* frames a second of the source; 0: none, the motion is continuous */
    uint32_t flags;                  /* FXS_MOTION_LOOPS, FXS_MOTION_TURNS, FXS_MOTION_FADES */
    uint32_t degree;                 /* of the polynomials of the position, 0 to 3 */
    uint32_t most_chunks;            /* largest number of chunks that are alive at one time, 1 or more */
    uint32_t cut_q16;                /* a Gaussian whose opacity has fallen by more octaves than this is not drawn */
    uint32_t reserved[9];            /* reserved bytes, which must be 0 */
} fxs_motion_header;

/* When a chunk is alive (drawn), and the unit of its motion. With t in seconds, its time u is (t - middle) / 2^(unit -
   16), limited to +-1. */
typedef struct fxs_chunk_motion {    /* the motion of a chunk has 16 bytes */
    int32_t from_q16, to_q16;        /* seconds: alive from `from` until before `to` */
    int32_t middle_q16;
    uint8_t unit;                    /* 0 to 30 */
    int8_t shift;                    /* position code = code + (sum of drift u^k) 2^shift, -15 to 4 */
    uint16_t reserved;               /* 0 */
} fxs_chunk_motion;

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
#define FXS_BIG_ENDIAN 1
#else
#define FXS_BIG_ENDIAN 0
#endif

/* Converts `count` numbers of `size` bytes, from byte `offset` on, between little-endian and the processor's byte
   order. */
static inline void fxs_little_endian(void *start, size_t offset, size_t count, size_t size)
{
    unsigned char *bytes = (unsigned char *)start + offset;
    for (size_t i = 0; FXS_BIG_ENDIAN && i < count; i++, bytes += size)
        for (size_t low = 0, high = size - 1; low < high; low++, high--) {
            const unsigned char byte = bytes[low];
            bytes[low] = bytes[high];
            bytes[high] = byte;
        }
}

static inline uint16_t fxs_little_16(uint16_t x)
{
    fxs_little_endian(&x, 0, 1, sizeof x);
    return x;
}

static inline uint32_t fxs_little_32(uint32_t x)
{
    fxs_little_endian(&x, 0, 1, sizeof x);
    return x;
}

static inline uint64_t fxs_little_64(uint64_t x)
{
    fxs_little_endian(&x, 0, 1, sizeof x);
    return x;
}

typedef char fxs_sizes_are_as_turned[sizeof(fxs_packed_header) == 4 * 8 + 8 * 12 + 4 * 6 + 8 * 3 + 4 * 4 &&
                                     sizeof(fxs_chunk) == 8 * 3 + 4 * 11 + 2 * 6 + 48 &&
                                     sizeof(fxs_tree_header) == 64 && sizeof(fxs_node) == 16 &&
                                     sizeof(fxs_motion_header) == 64 && sizeof(fxs_chunk_motion) == 16 ? 1 : -1];

static inline void fxs_packed_header_turn(fxs_packed_header *header)
{
    fxs_little_endian(header, 0, 8, 4);
    fxs_little_endian(header, offsetof(fxs_packed_header, low_q32), 12, 8);
    fxs_little_endian(header, offsetof(fxs_packed_header, profile), 6, 4);
    fxs_little_endian(header, offsetof(fxs_packed_header, start_q32), 3, 8);
    fxs_little_endian(header, offsetof(fxs_packed_header, start_rotation_q30), 4, 4);
}

static inline void fxs_chunk_turn(fxs_chunk *chunk)
{
    fxs_little_endian(chunk, 0, 3, 8);
    fxs_little_endian(chunk, offsetof(fxs_chunk, step_q32), 11, 4);
    fxs_little_endian(chunk, offsetof(fxs_chunk, sh_step_q19), 6, 2);
}

static inline void fxs_tree_header_turn(fxs_tree_header *header)
{
    fxs_little_endian(header, 0, sizeof *header / 4, 4);
}

static inline void fxs_node_turn(fxs_node *node)
{
    fxs_little_endian(node, 0, 2, 4);
    fxs_little_endian(node, offsetof(fxs_node, gain_q8), 4, 2);
}

static inline void fxs_motion_header_turn(fxs_motion_header *header)
{
    fxs_little_endian(header, 0, sizeof *header / 4, 4);
}

static inline void fxs_chunk_motion_turn(fxs_chunk_motion *motion)
{
    fxs_little_endian(motion, 0, 3, 4);
    fxs_little_endian(motion, offsetof(fxs_chunk_motion, reserved), 1, 2);
}

/* Returns the file version of a scene. */
static inline uint32_t fxs_packed_version(int moves, int has_tree)
{
    return moves ? (has_tree ? FXS_PACKED_VERSION_MOTION_TREE : FXS_PACKED_VERSION_MOTION)
                 : (has_tree ? FXS_PACKED_VERSION_TREE : FXS_PACKED_VERSION);
}

static inline int fxs_version_has_tree(uint32_t version)
{
    return version == FXS_PACKED_VERSION_TREE || version == FXS_PACKED_VERSION_MOTION_TREE;
}

static inline int fxs_version_moves(uint32_t version)
{
    return version == FXS_PACKED_VERSION_MOTION || version == FXS_PACKED_VERSION_MOTION_TREE;
}

/* Returns the bytes of the rows of motion of a chunk. */
static inline uint32_t fxs_motion_bytes(uint32_t degree, uint32_t flags)
{
    return FXS_CHUNK * (6 * degree + (flags & FXS_MOTION_TURNS ? 8u : 0u) + (flags & FXS_MOTION_FADES ? 4u : 0u));
}

/* Returns the bytes of the motion of a scene behind its palette: header, chunks' motions and padding. */
static inline uint64_t fxs_motion_table_bytes(uint64_t chunks)
{
    return (sizeof(fxs_motion_header) + chunks * sizeof(fxs_chunk_motion) + 63) / 64 * 64;
}

static inline int fxs_motion_header_valid(const fxs_motion_header *h, uint32_t chunks)
{
    return h->magic == FXS_MOTION_MAGIC && h->duration_q16 >= 1 && h->duration_q16 <= FXS_MOTION_DURATION_MOST &&
           h->degree <= FXS_MOTION_DEGREE && h->most_chunks >= 1 && h->most_chunks <= chunks;
}

static inline int fxs_chunk_motion_valid(const fxs_chunk_motion *motion)
{
    return motion->unit <= 30 && motion->shift >= -15 && motion->shift <= 4;
}

static inline int fxs_within(int64_t x, int64_t limit)
{
    return x >= -limit && x <= limit;
}

/* Returns 1 if every field of a chunk's header is in the range given in docs/format.md. */
static inline int fxs_chunk_valid(const fxs_chunk *chunk)
{
    int64_t scale = chunk->scale_q16, scale_reach = (int64_t)chunk->scale_step_q24 * (1023 * 1023) >> 8;
    if (chunk->step_shift > 12 || chunk->opacity_law >= FXS_OPACITY_LAWS)
        return 0;
    int valid = fxs_within(scale, 32 << 16) && fxs_within(scale - scale_reach, 32 << 16);
    for (int i = 0; i < 3; i++) {
        int64_t reach = (int64_t)chunk->step_q32[i] * 65535 << chunk->step_shift;
        int64_t colour = chunk->colour_q16[i], colour_reach = (int64_t)chunk->colour_step_q20[i] * FXS_COLOUR_MOST >> 4;
        valid = valid && fxs_within(chunk->origin_q32[i], (int64_t)1 << 60) &&
                fxs_within(chunk->origin_q32[i] + reach, (int64_t)1 << 60) && fxs_within(colour, 64 << 16) &&
                fxs_within(colour + colour_reach, 64 << 16) && chunk->sh_step_q19[i] <= 32767;
    }
    return valid;
}

/* Returns 1 if node i is valid in a scene with `leaves` chunks at the tree's leaves: two different children, each a
   leaf or a later node, and a field `swell` in range. */
static inline int fxs_node_valid(const fxs_node *node, uint32_t leaves, uint32_t i)
{
    int valid = node->swell_q8 <= FXS_SWELL_MOST_Q8;
    for (int k = 0; k < 2; k++)
        valid = valid && (node->children[k] < leaves ||
                          (node->children[k] > leaves + i && node->children[k] < 2 * leaves - 1));
    return valid && node->children[0] != node->children[1];
}

/* Returns the number of chunks of a scene, including the chunks of its tree. */
static inline uint32_t fxs_chunks_with_nodes(uint32_t leaves, int has_tree)
{
    return has_tree ? 2 * leaves - 1 : leaves;
}

static inline uint32_t fxs_scene_chunks(const fxs_scene *scene)
{
    return fxs_chunks_with_nodes(scene->chunk_count, scene->nodes != 0);
}

static inline uint32_t fxs_chunks_of(uint64_t slots)
{
    return (uint32_t)((slots + FXS_CHUNK - 1) / FXS_CHUNK);
}

/* Returns the number of SH coefficients above degree 0 per colour channel: 0, 3, 8, 15 for degrees 0 to 3. */
#define FXS_SH_COUNT(degree) (((degree) + 1) * ((degree) + 1) - 1)

#define FXS_ROW_POSITION 0u                              /* byte offsets of a chunk's rows (arrays of codes), profiles
                                                            default and compact */
#define FXS_ROW_ROTATION (6u * FXS_CHUNK)
#define FXS_ROW_SCALE (10u * FXS_CHUNK)
#define FXS_ROW_COLOUR (14u * FXS_CHUNK)
#define FXS_ROW_SH (18u * FXS_CHUNK)

#define FXS_SMALL_A 0u                                   /* byte offsets of a chunk's rows (arrays of codes), profile
                                                            small */
#define FXS_SMALL_B (4u * FXS_CHUNK)
#define FXS_SMALL_C (8u * FXS_CHUNK)
#define FXS_SMALL_D (12u * FXS_CHUNK)
#define FXS_SMALL_SH (13u * FXS_CHUNK)

#define FXS_ROTATION_BITS(profile) ((profile) == FXS_PROFILE_SMALL ? 23 : 32)
#define FXS_AXIS_BITS_LEAST(profile) ((profile) == FXS_PROFILE_SMALL ? 8 : 11)
#define FXS_AXIS_BITS_MOST(profile) ((profile) == FXS_PROFILE_SMALL ? 10 : 14)

/* Extracts the scale code of axis i from a scale word, 0 to 1023. The third axis has only even codes. */
static inline uint32_t fxs_scale_code(uint32_t word, int i)
{
    return i < 2 ? word >> 10 * i & 1023 : word >> 19 & 1022;
}

/* Decodes a scale code: returns the chunk's scale_q16 - log2(sigma), below 2^22. */
static inline int32_t fxs_fall_q16(uint32_t code, uint32_t scale_step_q24)
{
    return (int32_t)((code * code * scale_step_q24 + 128) >> 8);
}

/* Returns n, the number of bits of X and of Y in a rotation word. The word has the direction X, Y of the Gaussian's
   first axis, then the roll about the first axis. n grows by 5/16 for each octave between the lengths of the first axis
   and of the other axis nearest in length. */
static inline int32_t fxs_axis_bits(enum fxs_profile profile, const int32_t fall_q16[3])
{
    const int32_t most = FXS_AXIS_BITS_MOST(profile);
    const int32_t y_q16 = fall_q16[1] - fall_q16[0], z_q16 = fall_q16[2] - fall_q16[0];
    const int32_t y = y_q16 < 0 ? -y_q16 : y_q16, z = z_q16 < 0 ? -z_q16 : z_q16;
    const int32_t bits = FXS_AXIS_BITS_LEAST(profile) + (5 * ((y < z ? y : z) >> 4) >> 16);
    return bits < most ? bits : most;
}

/* Returns the number of SH palette stages. A Gaussian's SH are the chunk's mean SH plus or minus one palette entry of
   each stage, plus a residual in profile compact. */
static inline uint32_t fxs_palette_stages(enum fxs_profile profile, int degree)
{
    return degree == 0 || profile == FXS_PROFILE_DEFAULT ? 0
           : profile == FXS_PROFILE_COMPACT              ? 3
           : degree == 1                                 ? 4
                                                         : 6;
}

#define FXS_PALETTE_STAGES 6u                            /* largest number of SH palette stages */
#define FXS_PALETTE_ENTRIES 128u                         /* largest number of SH palette entries per stage */
#define FXS_PALETTE_STRIDE 48u                           /* size of an SH palette entry, bytes */
#define FXS_PALETTE_NEGATIVE 128u                        /* bit of a palette index that means: subtract the entry
                                                            instead of adding it */
#define FXS_GAIN_BYTE 3u                                 /* profile compact: byte of an SH record that holds the gain */
#define FXS_RESIDUAL_BIT 32u                             /* profile compact: bit of an SH record where the residual
                                                            begins */

static inline uint32_t fxs_sh_bytes(enum fxs_profile profile, int degree)
{
    const uint8_t compact[4] = {0, 8, 13, 21};
    return profile == FXS_PROFILE_DEFAULT   ? 3u * (uint32_t)FXS_SH_COUNT(degree)
           : profile == FXS_PROFILE_COMPACT ? compact[degree]
                                            : fxs_palette_stages(profile, degree);
}

static inline uint32_t fxs_chunk_bytes(enum fxs_profile profile, int degree)
{
    return (uint32_t)FXS_CHUNK * ((profile == FXS_PROFILE_SMALL ? 13u : 18u) + fxs_sh_bytes(profile, degree));
}

/* Returns the size of a scene's SH palette in bytes, a multiple of 64. */
static inline uint32_t fxs_palette_bytes(const fxs_scene *scene)
{
    const uint32_t stages = fxs_palette_stages(scene->profile, scene->sh_degree);
    return scene->palette ? (stages * scene->palette_entries * FXS_PALETTE_STRIDE + 63) / 64 * 64 : 0;
}

/* Returns the size in bytes of a packed scene without a tree. palette_entries is 0 to 128 per stage. Returns 0 if an
   argument is out of range. */
FXS_EXPERIMENTAL size_t fxs_scene_bytes(uint32_t count, int sh_degree, enum fxs_profile profile,
                                        uint32_t palette_entries);

/* Returns the size in bytes of a moving scene, whose motion has the given degree and flags, as fxs_scene_bytes does.
   With `has_tree`, the motion has room for the tree's nodes; the size is without the tree. */
FXS_EXPERIMENTAL size_t fxs_moving_scene_bytes(uint32_t count, int sh_degree, enum fxs_profile profile,
                                               uint32_t palette_entries, uint32_t degree, uint32_t flags, int has_tree);

/* Returns the size in bytes of the level-of-detail tree that follows `chunks` chunks with rows of `chunk_bytes` bytes.
   Returns 0 for fewer than two chunks, or if the size exceeds a size_t. */
FXS_EXPERIMENTAL size_t fxs_tree_bytes(uint32_t chunks, uint32_t chunk_bytes);

/* Writes the slot numbers of an open scene's Gaussians, as in fxs_id, to `numbers`, in the order of a stream of the
   scene. `numbers` has room for scene->count of them. They are 0, 1, 2 ... except in scenes with holes (empty slots
   before the last Gaussian). Returns the number of entries written, fewer than scene->count only if the scene is
   damaged. */
FXS_EXPERIMENTAL uint32_t fxs_scene_numbers(const fxs_scene *scene, uint32_t *numbers);

#ifdef __cplusplus
}
#endif

#endif
