/* Inner loops of packing in portable C, without vector instructions. */
#define ISA c
#include "palette_vector.h"

static inline void find_dots(int32_t dots[FXS_PALETTE_GROUP], const fxs_sh_vector vector, const fxs_sh_vector *others)
{
    for (int j = 0; j < FXS_PALETTE_GROUP; j++)
        dots[j] = dot(vector, others[j]);
}

/* Finds the smallest costs. Has no branches on costs, which would be unpredictable. */
static inline void find_leasts(int32_t *costs, uint32_t count, fxs_pack_place *found, uint32_t wanted)
{
    for (uint32_t n = 0; n < wanted; n++) {
        int32_t least = INT32_MAX, place = (int32_t)count;
        for (uint32_t i = 0; i < count; i++)
            least = costs[i] < least ? costs[i] : least;
        for (uint32_t i = 0; i < count; i++) {
            const int32_t here = costs[i] == least ? (int32_t)i : (int32_t)count;
            place = here < place ? here : place;
        }
        costs[place] = INT32_MAX;
        found[n] = (fxs_pack_place){least, (uint32_t)place};
    }
}

#include "pack_stages.h"
